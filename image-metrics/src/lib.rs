//! Errors between images: relMSE, PSNR, MS-SSIM, energy.
