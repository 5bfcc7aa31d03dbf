//! The checks behind [`SceneData::validate`].

use super::{Environment, Material, NONE, PunctualLight, SceneData, SceneError};

/// By how much a direction's squared length may differ from 1: some units of f32, and a file's decimals.
const UNIT: f32 = 1e-3;

type Checked = Result<(), SceneError>;

/// All checks; the first failure is returned.
pub(super) fn scene(scene: &SceneData) -> Checked {
    sizes(scene)?;
    geometry(scene)?;
    shading(scene)?;
    surfaces(scene)?;
    environment(scene)?;
    scene.opacity.view().check(scene.indices.len()).map_err(SceneError::Opacity)
}

fn sizes(scene: &SceneData) -> Checked {
    for (list, found) in [
        ("positions", scene.positions.len()),
        ("triangles", scene.indices.len()),
        ("meshes", scene.meshes.len()),
        ("instances", scene.instances.len()),
        ("materials", scene.materials.len()),
        ("textures", scene.textures.len()),
        ("texels", scene.texels.len()),
        ("punctual lights", scene.punctual_lights.len()),
    ] {
        let limit = u64::from(NONE) - 1;
        if found as u64 > limit {
            return Err(SceneError::TooLarge { list, found: found as u64, limit });
        }
    }
    if !scene.uv2.is_empty() {
        length("second texture coordinates", scene.uv2.len() as u64, scene.indices.len() as u64)?;
    }
    length("triangle shading", scene.triangle_shading.len() as u64, scene.indices.len() as u64)
}

fn geometry(scene: &SceneData) -> Checked {
    for (i, triangle) in scene.indices.iter().enumerate() {
        for &vertex in triangle {
            index("triangle", i, vertex, scene.positions.len())?;
        }
    }
    numbers("vertex", scene.positions.iter().map(|p| p.iter().all(|x| x.is_finite())))?;
    for (i, mesh) in scene.meshes.iter().enumerate() {
        // The index after the last triangle may equal the length.
        let end = mesh.first_triangle.saturating_add(mesh.triangle_count);
        index("mesh", i, end, scene.indices.len() + 1)?;
    }
    for (i, instance) in scene.instances.iter().enumerate() {
        index("instance", i, instance.mesh, scene.meshes.len())?;
    }
    numbers("instance", scene.instances.iter().map(|i| i.to_scene.as_flattened().iter().all(|x| x.is_finite())))
}

fn shading(scene: &SceneData) -> Checked {
    for (i, shading) in scene.triangle_shading.iter().enumerate() {
        index("triangle's material", i, shading.material, scene.materials.len())?;
    }
    numbers(
        "texture coordinate",
        scene.triangle_shading.iter().map(|s| s.uv.as_flattened().iter().all(|x| x.is_finite())),
    )?;
    numbers("second texture coordinate", scene.uv2.iter().map(|uv| uv.as_flattened().iter().all(|x| x.is_finite())))
}

fn surfaces(scene: &SceneData) -> Checked {
    numbers("material", scene.materials.iter().map(material))?;
    numbers("punctual light", scene.punctual_lights.iter().map(punctual))?;
    numbers("texture", scene.textures.iter().map(|t| t.uv_rows.as_flattened().iter().all(|x| x.is_finite())))?;
    for (i, material) in scene.materials.iter().enumerate() {
        for &texture in material.textures.iter().filter(|&&texture| texture != NONE) {
            index("material's texture", i, texture, scene.textures.len())?;
        }
    }
    for (i, texture) in scene.textures.iter().enumerate() {
        let texels = u64::from(texture.width) * u64::from(texture.height);
        if texels == 0 {
            return Err(SceneError::Length { list: "texture", found: 0, expected: 1 });
        }
        let last = (u64::from(texture.first_texel) + texels - 1).min(u64::from(NONE)) as u32;
        index("texture", i, last, scene.texels.len())?;
    }
    Ok(())
}

/// Light, and whatever else has no negative amount.
fn light(x: f32) -> bool {
    x.is_finite() && x >= 0.0
}

fn material(material: &Material) -> bool {
    let Material { base_color, emission, specular, interior, surface, coat, .. } = material;
    // Factors on the tangential parts of normals turn these round when negative.
    let ([amounts @ .., scale], [coat, coat_roughness, coat_scale, _]) = (surface, coat);
    let amounts = amounts.iter().chain([coat, coat_roughness]);
    let finite = scale.is_finite() && coat_scale.is_finite();
    let colors = base_color.iter().chain(emission).chain(specular).chain(interior);
    finite && colors.chain(amounts).copied().all(light)
}

fn punctual(source: &PunctualLight) -> bool {
    let PunctualLight { position, direction, intensity, range } = source;
    let [x, y, z, inner] = *direction;
    let kinds = [PunctualLight::POINT, PunctualLight::SPOT, PunctualLight::DIRECTIONAL];
    let length = (x * x + y * y + z * z - 1.0).abs();
    let finite = position.iter().chain(direction).chain(intensity).chain(range).all(|x| x.is_finite());
    let cosines = inner.abs() <= 1.0 && intensity[3].abs() <= 1.0;
    finite
        && kinds.contains(&position[3])
        && length < UNIT
        && cosines
        && intensity[..3].iter().copied().all(light)
        && range[0] >= 0.0
}

fn environment(scene: &SceneData) -> Checked {
    numbers("environment's rotation", core::iter::once(scene.environment_rotation.is_finite()))?;
    match &scene.environment {
        None => Ok(()),
        Some(Environment::Constant(radiance)) => {
            numbers("environment", core::iter::once(radiance.iter().copied().all(light)))
        }
        Some(Environment::Image(image)) => {
            let texels = u64::from(image.width) * u64::from(image.height);
            length("environment's texels", image.texels.len() as u64, texels.max(1))?;
            numbers("environment's texel", image.texels.iter().map(|t| t[..3].iter().copied().all(light)))
        }
    }
}

fn index(at: &'static str, element: usize, index: u32, length: usize) -> Checked {
    if (index as usize) < length {
        Ok(())
    } else {
        Err(SceneError::Index { at, element: element as u32, index, length: length as u32 })
    }
}

fn length(list: &'static str, found: u64, expected: u64) -> Checked {
    if found == expected { Ok(()) } else { Err(SceneError::Length { list, found, expected }) }
}

fn numbers(at: &'static str, mut good: impl Iterator<Item = bool>) -> Checked {
    match good.position(|good| !good) {
        None => Ok(()),
        Some(element) => Err(SceneError::Number { at, element: element as u32 }),
    }
}
