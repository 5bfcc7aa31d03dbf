//! Features that a scene may do without, by name; each can be forced on to see that nothing but time changes.

use pt_integrator::scene::Needs as Bits;
use serde::Serialize;

use crate::needs::Needs;

/// Something that frames model only where the scene has it.
#[derive(Clone, Copy, Debug)]
pub struct Feature {
    /// Its name, as `needs.force` takes it.
    pub name: &'static str,
    /// What the scene then has.
    pub about: &'static str,
    /// Its bits of the tracing loop; 0 for layers.
    pub(crate) bits: u32,
    /// A set of features with one bit each.
    mask: u32,
    is_needed: fn(&Needs) -> bool,
}

macro_rules! features {
    ($($name:literal, $bits:expr, $about:literal, $is_needed:expr;)*) => {
        /// All features.
        pub static FEATURES: &[Feature] = {
            const ALL: &[Feature] = &[
                $(Feature { name: $name, about: $about, bits: $bits, mask: 0, is_needed: $is_needed }),*
            ];
            &numbered::<{ ALL.len() }>(ALL)
        };
    };
}

features! {
    "textures", Bits::TEXTURES, "textures of what surfaces scatter", |needs| needs.textures;
    "triangle_lights", Bits::TRIANGLE_LIGHTS, "emissive triangles", |needs| needs.emissive_triangles > 0;
    "environment_image", Bits::ENVIRONMENT_IMAGE, "an environment image", |needs| needs.environment == "image";
    "glossy", Bits::GLOSSY, "lobes that are not diffuse", Needs::is_glossy;
    "transmission", Bits::TRANSMISSION, "surfaces that light passes", |needs| needs.lobes.contains(&"transmission");
    "coat", Bits::COAT, "clear coats", |needs| needs.lobes.contains(&"coat");
    "normal_maps", Bits::NORMAL_MAPS, "normal maps", |needs| needs.normal_maps;
    "punctual_lights", Bits::PUNCTUAL, "lights without extent", |needs| needs.punctual_lights > 0;
    "emissive_textures", Bits::EMISSIVE_TEXTURES, "textures of emission", |needs| needs.emissive_textures;
    "layers", 0, "vertices behind mirrors and glass, filtered by themselves", |needs| needs.layers > 1;
}

/// Gives each its bit.
const fn numbered<const N: usize>(all: &[Feature]) -> [Feature; N] {
    let mut features = [all[0]; N];
    let mut k = 0;
    while k < N {
        features[k] = all[k];
        features[k].mask = 1 << k;
        k += 1;
    }
    features
}

impl Feature {
    /// Whether these are the layers of the filter rather than a part of the tracing loop.
    pub(crate) const fn is_layers(&self) -> bool {
        self.bits == 0
    }

    /// Whether a scene needs it.
    pub fn is_needed(&self, needs: &Needs) -> bool {
        (self.is_needed)(needs)
    }
}

/// A set of features.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FeatureSet(u32);

impl FeatureSet {
    /// None.
    pub const NONE: Self = Self(0);

    /// Reads `none`, `all`, or names with commas between.
    ///
    /// ```
    /// use hashcache::feature::FeatureSet;
    /// let set = FeatureSet::parse("coat,textures")?;
    /// assert_eq!(set.to_string(), "textures,coat");
    /// assert!(FeatureSet::parse("velvet").is_err());
    /// # Ok::<(), String>(())
    /// ```
    ///
    /// # Errors
    /// What it takes.
    pub fn parse(text: &str) -> Result<Self, String> {
        let all = || FEATURES.iter().fold(0, |set, feature| set | feature.mask);
        let of = |name: &str| FEATURES.iter().find(|feature| feature.name == name).map(|feature| feature.mask);
        let masks: Option<u32> = match text {
            "none" => Some(0),
            "all" => Some(all()),
            names => names.split(',').map(of).try_fold(0, |set, mask| Some(set | mask?)),
        };
        let names = || FEATURES.iter().map(|feature| feature.name).collect::<Vec<_>>().join(", ");
        masks.map(Self).ok_or_else(|| format!("none, all, or some of these with commas between: {}", names()))
    }

    /// A set of one.
    pub const fn of(feature: &Feature) -> Self {
        Self(feature.mask)
    }

    /// Whether a feature is in the set.
    pub const fn contains(self, feature: &Feature) -> bool {
        self.0 & feature.mask != 0
    }

    /// The features.
    pub fn iter(self) -> impl Iterator<Item = &'static Feature> {
        FEATURES.iter().filter(move |feature| self.contains(feature))
    }

    /// Bits of the tracing loop.
    pub(crate) fn loop_bits(self) -> u32 {
        self.iter().fold(0, |bits, feature| bits | feature.bits)
    }

    /// Whether layers are in the set.
    pub(crate) fn has_layers(self) -> bool {
        self.iter().any(Feature::is_layers)
    }
}

impl std::fmt::Display for FeatureSet {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let names: Vec<_> = self.iter().map(|feature| feature.name).collect();
        f.write_str(if names.is_empty() { "none" } else { "" })?;
        f.write_str(&names.join(","))
    }
}

/// A feature that the scene does without, and what that saves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Saving {
    /// The feature's name.
    pub feature: &'static str,
    /// What scenes with it have.
    pub about: &'static str,
    /// Bytes of buffers that would otherwise be there.
    pub bytes: u64,
    /// CPU nanoseconds a sample, where they were measured.
    pub ns_per_sample: Option<f64>,
}
