//! Pictures of our path tracer beside those of an independent renderer (Mitsuba 3), where they are at hand.

use std::path::{Path, PathBuf};

use hashcache::choice::{CacheKind, FilterKind};
use hashcache::{Image, Preview, Settings, image_file};
use image_metrics::{BlockTest, ImageView, Margin, block_test, energy_ratio, rel_mse_trimmed};
use serde_json::Value;

/// The scenes that have a reference: Lambertian ones with area lights or an environment, one with punctual lights, and
/// one with a mirror and glass.
pub const SCENES: [&str; 7] = [
    "cornell-box",
    "modern-hall",
    "living-room",
    "wooden-staircase",
    "country-kitchen",
    "sunny-blocks",
    "cornell-specular",
];

/// What a block's mean may differ from the reference's without being held against us: a thousandth for what shading
/// normals that lie against their face are worth to two renderers, and a tenth of the darkest step of an 8-bit sRGB
/// texture (1/255/12.92), since two JPEG decoders do not round alike and wood holds almost no blue.
pub const BLOCK_MARGIN: Margin = Margin { relative: 1e-3, absolute: 3e-5 };

/// Probability of calling an unbiased picture biased.
pub const FALSE_ALARM: f64 = 1e-4;

/// Most that trimmed relMSE may exceed Mitsuba's at the same number of samples.
pub const TRIMMED_RATIO: f64 = 1.15;

/// Most that a channel's energy may differ from the reference's.
pub const ENERGY_TOLERANCE: f64 = 0.003;

/// A scene with its reference.
pub struct Reference {
    /// The scene's name.
    pub name: &'static str,
    scene: PathBuf,
    environment: Option<PathBuf>,
    mean: Image,
    variance: Image,
    own_relmse: f64,
    trimmed_64: f64,
}

/// What several seeds of one scene gave.
pub struct Measured {
    /// ΣI/ΣR of the seeds' mean, by channel.
    pub energy: [f64; 3],
    /// Standard deviation of `energy`, from the spread between seeds.
    pub energy_sigma: [f64; 3],
    /// relMSE without the worst 0.1 % of pixels, mean of the seeds.
    pub trimmed: f64,
    /// The same of Mitsuba's path tracer at as many samples.
    pub trimmed_mitsuba: f64,
    /// 16×16 blocks of all seeds against the reference.
    pub blocks: BlockTest,
    /// Pixel samples per CPU-second.
    pub samples_per_cpu_s: f64,
}

/// Where the shared scenes and references are, or `None` with a line that says so.
pub fn shared() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let shared = std::env::var_os("HASHCACHE_SHARED").map_or_else(|| root.join("../shared"), PathBuf::from);
    if shared.join("refs/scenes").is_dir() {
        return Some(shared);
    }
    eprintln!("skipped: no shared scenes at {}; set HASHCACHE_SHARED", shared.display());
    None
}

impl Reference {
    /// Reads a reference.
    ///
    /// # Panics
    /// When a file is missing or broken.
    pub fn read(shared: &Path, name: &'static str) -> Self {
        let folder = shared.join("refs/scenes");
        let text = std::fs::read_to_string(folder.join(format!("{name}.json"))).expect("the reference has facts");
        let facts: Value = serde_json::from_str(&text).expect("facts are JSON");
        let image = |suffix: &str| {
            image_file::read(&folder.join(format!("{name}{suffix}.exr"))).expect("the reference can be read")
        };
        let number = |key: &str| facts[key].as_f64().expect("a figure of the reference");
        let scenes = shared.join("scenes");
        let environment = facts["args"].as_array().and_then(|arguments| arguments.get(1)).and_then(Value::as_str);
        Self {
            name,
            scene: scenes.join(facts["scene"].as_str().expect("the scene's file")),
            environment: environment.map(|file| file.replace("{scenes}", &scenes.to_string_lossy()).into()),
            mean: image(""),
            variance: image("-variance"),
            own_relmse: number("relmse_self"),
            trimmed_64: number("relmse_64spp_trimmed"),
        }
    }

    /// Settings that show what the reference shows.
    pub fn settings(&self) -> Settings {
        Settings {
            cache: CacheKind::None,
            filter: FilterKind::None,
            size: Some((self.mean.width, self.mean.height)),
            env: self.environment.clone(),
            ..Settings::default()
        }
    }

    /// Opens the scene.
    ///
    /// # Panics
    /// When it cannot be loaded.
    pub fn open(&self, settings: &Settings) -> Preview {
        Preview::open(&self.scene.to_string_lossy(), settings).expect("the shared scene loads")
    }

    /// Renders `seeds` pictures of `spp` samples a pixel and compares them with the reference.
    ///
    /// # Panics
    /// When a render fails or the pictures cannot be compared.
    pub fn measure(&self, seeds: u32, spp: u32) -> Measured {
        let mut preview = self.open(&Settings { spp, ..self.settings() });
        let (mut runs, mut cpu_s) = (Vec::new(), 0.0);
        for seed in 1..=seeds {
            preview = preview.with_seed(seed);
            let rendered = preview.render(&mut |_| ()).expect("the scene renders");
            assert_eq!(rendered.stats.non_finite, 0, "{}: paths were dropped", self.name);
            cpu_s += rendered.stats.cpu_s.stages["trace"];
            runs.push(rendered.image);
        }
        let (reference, variance) = (view(&self.mean), view(&self.variance));
        let views: Vec<ImageView> = runs.iter().map(view).collect();
        let ratios: Vec<[f64; 3]> =
            views.iter().map(|run| energy_ratio(*run, reference).expect("one size").channels).collect();
        let trimmed: f64 = views.iter().map(|run| rel_mse_trimmed(*run, reference).expect("one size")).sum();
        let (energy, energy_sigma) = mean_and_sigma(&ratios);
        let paths = f64::from(self.mean.width * self.mean.height) * f64::from(spp) * f64::from(seeds);
        Measured {
            energy,
            energy_sigma,
            trimmed: trimmed / f64::from(seeds),
            trimmed_mitsuba: (self.trimmed_64 - self.own_relmse) * 64.0 / f64::from(spp) + self.own_relmse,
            blocks: block_test(&views, reference, variance, BLOCK_MARGIN).expect("two runs of one size"),
            samples_per_cpu_s: paths / cpu_s,
        }
    }
}

fn view(image: &Image) -> ImageView<'_> {
    ImageView::new(image.width as usize, image.height as usize, &image.pixels).expect("a finite picture")
}

/// Mean of the seeds by channel, and the standard deviation of that mean.
fn mean_and_sigma(ratios: &[[f64; 3]]) -> ([f64; 3], [f64; 3]) {
    let n = ratios.len() as f64;
    let channel = |c: usize| {
        let mean = ratios.iter().map(|ratio| ratio[c]).sum::<f64>() / n;
        let variance = ratios.iter().map(|ratio| (ratio[c] - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
        (mean, (variance / n).sqrt())
    };
    let all = [channel(0), channel(1), channel(2)];
    (all.map(|(mean, _)| mean), all.map(|(_, sigma)| sigma))
}
