//! How far an image is from a reference: relMSE, MSE, PSNR, MS-SSIM, FLIP, the energy ratio, flicker, and a test for bias.
//!
//! ```
//! use image_metrics::{ImageView, psnr, rel_mse};
//!
//! let image = [[1.1_f32, 0.5, 0.0]; 4];
//! let reference = [[1.0_f32, 0.5, 0.0]; 4];
//! let image = ImageView::new(2, 2, &image)?;
//! let reference = ImageView::new(2, 2, &reference)?;
//! // One channel of three is off by a tenth: 0.1² / (1² + 0.01) / 3.
//! assert!((rel_mse(image, reference)? - 0.01 / 1.01 / 3.0).abs() < 1e-8);
//! // The screen clips at 1, so on the screen the two are equal.
//! assert_eq!(psnr(image, reference)?, f64::INFINITY);
//! # Ok::<(), image_metrics::Error>(())
//! ```
//!
//! # Concepts
//! - An [`ImageView`] borrows pixels: linear light, Rec. 709 primaries, `[f32; 3]` a pixel, row by row from the upper left.
//!   It cannot be made from pixels that are NaN or infinite: they are counted and are an error. What comes after never meets one.
//! - [`rel_mse`], [`rel_mse_trimmed`], [`mse`], [`energy_ratio`] and [`flicker`] see linear light, unclipped.
//!   [`psnr`], [`ms_ssim`] and [`flip`] see what a screen shows: clipped to `[0, 1]` and sRGB-encoded by [`srgb_encode`]
//!   (FLIP undoes the encoding first, so it takes the clipped light as it is).
//! - An error of an image says nothing about its cause, noise or bias. [`block_test`] tells them apart: it compares several
//!   independent runs with a reference of known variance, block by block, and its false alarms have a known probability.
//!
//! # Memory
//! Two images in, numbers out. Meanwhile [`rel_mse_trimmed`] and [`rel_mse_map`] hold 8 bytes a pixel, [`ms_ssim`] 20 bytes
//! a pixel and 440 bytes a column, [`flip`] 4 bytes a pixel and 2.6 kB a column, [`block_test`] 288 bytes a block of 256 pixels:
//! for 1024×576 4.5, 11.7, 4.8 and 0.6 MiB.
//!
//! # Determinism
//! Sums are `f64`, in a fixed order, on one thread: the same images give the same bits.
//!
//! # Limits today
//! RGB only, no alpha. FLIP at one viewing distance, no HDR-FLIP.
//!
//! # Source
//! [`flicker`]: Chaitanya et al. 2017.
//! [`flip`]: Andersson et al. 2020.
//! [`ms_ssim`]: Wang et al. 2003.
//! [`rel_mse`]: Rousselle et al. 2011.

mod absolute;
mod block_test;
mod energy;
mod error;
mod flip;
mod image;
mod relative;
mod srgb;
mod ssim;
mod temporal;

pub use absolute::{mse, psnr};
pub use block_test::{BEYOND, BLOCK, BlockScore, BlockTest, Margin, block_test};
pub use energy::{EnergyRatio, energy_ratio};
pub use error::Error;
pub use flip::{FLIP_PIXELS_PER_DEGREE, flip, flip_map};
pub use image::ImageView;
pub use relative::{REL_MSE_EPSILON, WORST_SHARE, rel_mse, rel_mse_map, rel_mse_trimmed};
pub use srgb::srgb_encode;
pub use ssim::{MS_SSIM_MIN_SIDE, ms_ssim};
pub use temporal::flicker;
