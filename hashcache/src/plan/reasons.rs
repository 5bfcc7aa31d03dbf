//! Why a frame has its stages, in words.

use crate::accuracy::CONFIDENCE;
use crate::choice::{CacheKind, Choice as _, DirectLight, FilterKind, Moments};
use crate::filter::has_wide_pass;
use crate::needs::{LEAST_ROUGHNESS, Needs};
use crate::settings::Settings;

/// What reasons are given by.
pub(super) struct Reasons<'a> {
    pub needs: &'a Needs,
    pub settings: &'a Settings,
    pub layers: u32,
}

impl Reasons<'_> {
    pub fn film(&self) -> String {
        let (bounces, surfaces, lights) = (self.settings.max_bounces, self.surfaces(), self.lights());
        let moments = match self.settings.path_moments {
            Moments::Off => "",
            Moments::On => ", with how they scatter",
        };
        format!("whole paths of up to {bounces} scatterings into the film{moments}, no cache: {surfaces}; {lights}")
    }

    pub fn trace(&self) -> String {
        let vertex = if self.needs.is_glossy() { "first diffuse vertex" } else { "first vertex" };
        let kept = match (self.settings.cache, self.settings.store) {
            (CacheKind::None, _) => format!("their {vertex} kept for the filter"),
            (cache, 1) => format!("their {vertex} recorded for the {}", cache.name()),
            (cache, store) => format!("their first {store} vertices recorded for the {}", cache.name()),
        };
        let (bounces, surfaces, lights) = (self.settings.max_bounces, self.surfaces(), self.lights());
        format!("paths of up to {bounces} scatterings, {kept}: {surfaces}; {lights}")
    }

    pub fn grid_update(&self) -> String {
        let history = match self.settings.grid_history {
            0 => String::new(),
            most => format!("; of earlier frames they keep at most {most} vertices"),
        };
        format!("the vertices' cells are claimed and their light is added to them{history}")
    }

    pub fn reconstruct(&self) -> String {
        let direct = match self.settings.direct {
            DirectLight::Cached => String::new(),
            DirectLight::Traced => format!(", each with {} shadow rays for direct light", self.settings.direct_samples),
        };
        let least = self.settings.reconstruct_samples;
        let through = match self.layers {
            1 if self.needs.is_glossy() => ", by whatever lobes to the first diffuse vertex".to_owned(),
            1 => String::new(),
            layers => format!(", through mirrors and glass too: up to {layers} vertices one behind another"),
        };
        format!("at least {least} samples a pixel show what it sees, for clean edges{direct}{through}")
    }

    pub fn gather(&self) -> String {
        match self.layers {
            1 => "samples become sums of light, albedo and guides a pixel".to_owned(),
            layers => format!("samples become sums of light, albedo and guides a pixel, in each of {layers} layers"),
        }
    }

    pub fn filter(&self) -> String {
        let (denoiser, passes) = (self.settings.denoiser.name(), self.settings.filter_passes);
        let wide = match self.settings.filter_wide_radius {
            radius if has_wide_pass(self.settings) => {
                format!(", after a wide one of up to {radius} pixels over the cache's light in the first layer")
            }
            _ => String::new(),
        };
        let over = format!("{denoiser} over the light without albedo, passes: {passes}{wide}");
        let rough = if self.needs.rough_lobes { "; through rough lobes once more" } else { "" };
        match (self.settings.filter, self.layers) {
            (FilterKind::None, _) => {
                "no filter: sums become radiance, pixels without light take their neighbours'".to_owned()
            }
            (FilterKind::Layered, 1) if self.needs.is_glossy() => {
                format!("{over}; in one layer: what each pixel's path shows first that is diffuse")
            }
            (FilterKind::Layered, 1) => format!("{over}; in one layer: nothing reflects or lets light through"),
            (FilterKind::Layered, layers) => {
                format!("{over}; in {layers} layers, the deepest first, each by its own guides{rough}")
            }
            (FilterKind::Screen, 1) => format!("{over}; by the surfaces seen"),
            (FilterKind::Screen, _) => {
                format!("{over}; and over all light from behind at once, by the surfaces seen first")
            }
        }
    }

    pub fn check(&self, pixels: u32) -> String {
        let (percent, spp) = (100.0 * self.settings.check_fraction, self.settings.check_spp);
        let about = self.settings.check_fraction * f64::from(pixels);
        format!(
            "{percent} % of the pixels, about {about:.0}, are also traced by {spp} paths each without cache and filter: \
             the picture's bias, with an interval of {:.0} % confidence",
            100.0 * CONFIDENCE
        )
    }

    fn lights(&self) -> String {
        let some = lights(self.needs);
        if some.is_empty() {
            return "nothing gives light, so rays show a black scene".to_owned();
        }
        format!("lit by {}", some.join(" and "))
    }

    fn surfaces(&self) -> String {
        let needs = self.needs;
        let instances =
            if needs.instances > 1 { format!("{} instances", needs.instances) } else { "one mesh".to_owned() };
        let lobes = match needs.lobes[..] {
            [] => "no lobes".to_owned(),
            ["diffuse"] => "Lambert".to_owned(),
            ref lobes => lobes.join(" + "),
        };
        let textures = if needs.textures { "textured" } else { "no texture code" };
        format!("{} triangles in {instances}, {lobes}, {textures}", needs.triangles)
    }
}

fn lights(needs: &Needs) -> Vec<String> {
    let count = |n: u64, what: &str| (n > 0).then(|| format!("{n} {what}"));
    let environment = (needs.environment != "none").then(|| format!("a {} environment", needs.environment));
    let lights = [
        count(needs.emissive_triangles, "emissive triangles"),
        count(needs.punctual_lights, "lights without extent"),
        environment,
    ];
    lights.into_iter().flatten().collect()
}

/// What the scene needs, each with what asks for it.
pub(super) fn needs(needs: &Needs) -> Vec<(&'static str, String)> {
    let mut all = Vec::new();
    let mut push = |on: bool, need: &'static str, why: String| {
        if on {
            all.push((need, why));
        }
    };
    for lobe in &needs.lobes {
        let why = match *lobe {
            "diffuse" => "surfaces scatter evenly: caches hold their light",
            "reflection" => "metals, or dielectrics with a specular factor above 0: traced on, never cached",
            "transmission" => "surfaces that light passes: traced on, never cached",
            _ => "clear coats: traced on, never cached",
        };
        push(true, lobe, why.to_owned());
    }
    let rough = format!("roughness from {LEAST_ROUGHNESS} on: light through them is filtered again");
    push(needs.rough_lobes, "rough lobes", rough);
    push(needs.textures, "textures", "materials vary over surfaces".to_owned());
    push(needs.normal_maps, "normal maps", "surfaces have relief".to_owned());
    push(needs.alpha_masks, "alpha masks", "triangles have holes: rays read opacity at every hit".to_owned());
    push(needs.second_uv, "second coordinates", "a texture reads them".to_owned());
    push(needs.vertex_normals, "vertex normals", "triangles stand for curved surfaces".to_owned());
    push(needs.instances > 1, "instances", format!("{} placed meshes: rays go through two levels", needs.instances));
    let lights = lights(needs);
    push(!lights.is_empty(), "lights", lights.join(" and "));
    push(needs.emissive_textures, "emissive textures", "emission varies over triangles".to_owned());
    let behind = "what is seen first, and what is seen through it by reflection or transmission";
    let layers = format!("up to {} vertices one behind another: {behind}", needs.layers);
    push(needs.layers > 1, "layers", layers);
    all
}
