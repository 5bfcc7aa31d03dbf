//! Meshes, nodes and instances.
#![expect(clippy::float_cmp, reason = "values that are copied or exact come out exactly")]

mod common;

use common::{F32, Gltf, I8, I16, SQUARE, TRIANGLE, U8, U16, U32, corners, front, warned};
use hashcache_core::pack::octahedral_decode;
use scene::glam::{DVec3, Vec3};
use serde_json::json;

#[test]
fn a_triangle_without_indices() {
    let loaded = Gltf::triangle().load().unwrap();
    assert_eq!(corners(&loaded, 0, 0), TRIANGLE.map(Vec3::from));
    assert_eq!(loaded.origin, DVec3::ZERO);
    assert_eq!((loaded.info.triangles, loaded.info.meshes, loaded.info.instances), (1, 1, 1));
    assert!(loaded.data.triangle_shading[0].is_flat());
    assert!(loaded.cameras.is_empty());
    assert_eq!(loaded.info.extent, [[0.0; 3], [1.0, 1.0, 0.0]]);
}

#[test]
fn indices_of_every_width() {
    for (component, bytes) in
        [(U8, vec![0, 2, 1]), (U16, vec![0, 0, 2, 0, 1, 0]), (U32, vec![0, 0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0])]
    {
        let mut file = Gltf::triangle();
        let indices = file.accessor(&bytes, component, "SCALAR", 3);
        file.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
        let loaded = file.load().unwrap();
        assert_eq!(loaded.data.indices, [[0, 2, 1]]);
        assert_eq!(front(&loaded, 0, 0), Vec3::NEG_Z);
    }
}

#[test]
fn strips_and_fans_face_one_way() {
    for (mode, order) in [(5, [0, 1, 3, 2]), (6, [0, 1, 2, 3])] {
        let mut file = Gltf::new();
        let position = file.vec3(&SQUARE);
        let indices = file.indices(&order);
        file.mesh(json!([{"attributes": {"POSITION": position}, "indices": indices, "mode": mode}]));
        file.node(json!({"mesh": 0}));
        let loaded = file.load().unwrap();
        assert_eq!(loaded.info.triangles, 2);
        assert_eq!([front(&loaded, 0, 0), front(&loaded, 0, 1)], [Vec3::Z; 2], "mode {mode}");
    }
}

#[test]
fn points_lines_and_left_over_corners_are_named() {
    let mut file = Gltf::triangle();
    let indices = file.indices(&[0, 1, 2, 0]);
    file.json["meshes"][0]["primitives"] = json!([
        {"attributes": {"POSITION": 0}, "mode": 0},
        {"attributes": {"POSITION": 0}, "mode": 3},
        {"attributes": {"POSITION": 0}, "indices": indices},
    ]);
    let loaded = file.load().unwrap();
    assert_eq!(loaded.info.triangles, 1);
    assert_eq!(warned(&loaded, "points and lines"), Some("/meshes/0/primitives/0/mode"));
    assert_eq!(loaded.warnings.iter().find(|w| w.what.contains("points")).unwrap().count, 2);
    assert_eq!(warned(&loaded, "left-over corners"), Some("/meshes/0/primitives/2"));
}

#[test]
fn nodes_compose_matrices_and_translation_rotation_scale() {
    let mut file = Gltf::triangle();
    let half = std::f32::consts::FRAC_1_SQRT_2;
    // Scaled by 2, turned +90° about y (x to -z), moved by (0, 5, 0); the parent moves by (10, 0, 0).
    file.json["nodes"] = json!([
        {"children": [1], "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1]},
        {"mesh": 0, "translation": [0, 5, 0], "rotation": [0, half, 0, half], "scale": [2, 2, 2]},
    ]);
    let loaded = file.load().unwrap();
    let placed = corners(&loaded, 0, 0).map(|p| p.as_dvec3() + loaded.origin);
    let expected = [DVec3::new(10.0, 5.0, 0.0), DVec3::new(10.0, 5.0, -2.0), DVec3::new(10.0, 7.0, 0.0)];
    for (p, e) in placed.iter().zip(expected) {
        assert!(p.abs_diff_eq(e, 1e-6), "{p} {e}");
    }
}

#[test]
fn a_mirroring_node_keeps_the_front_outside() {
    for copies in [1, 2] {
        let mut file = Gltf::triangle();
        file.json["nodes"][0] = json!({"mesh": 0, "scale": [-1, 1, 1]});
        for _ in 1..copies {
            file.node(json!({"mesh": 0}));
        }
        let loaded = file.load().unwrap();
        assert_eq!(loaded.info.instances, copies);
        assert_eq!(front(&loaded, 0, 0), Vec3::Z, "{copies} copies");
        assert_eq!(corners(&loaded, 0, 0).iter().map(|p| p.x).fold(0.0, f32::min), -1.0);
    }
}

#[test]
fn meshes_placed_twice_are_instances() {
    let mut file = Gltf::triangle();
    file.node(json!({"mesh": 0, "translation": [4e6, 0, 0], "scale": [1, 3, 1]}));
    file.node(json!({"mesh": 0, "translation": [4e6, 1, 0], "scale": [1, -1, 1]}));
    let loaded = file.load().unwrap();
    assert_eq!((loaded.info.stored_triangles, loaded.info.triangles, loaded.info.instances), (1, 3, 3));
    assert_eq!(loaded.data.instances.iter().map(|i| i.mirrored).collect::<Vec<_>>(), [0, 0, 1]);
    let world = |i: usize| corners(&loaded, i, 0).map(|p| p.as_dvec3() + loaded.origin);
    assert!(world(0)[1].abs_diff_eq(DVec3::X, 1e-6));
    assert!(world(1)[2].abs_diff_eq(DVec3::new(4e6, 3.0, 0.0), 1e-6));
}

#[test]
fn a_mesh_far_from_its_own_zero_keeps_its_shape_when_instanced() {
    let mut file = Gltf::new();
    let far = TRIANGLE.map(|[x, y, z]| [x + 1e6, y, z]);
    let position = file.vec3(&far);
    file.mesh(json!([{"attributes": {"POSITION": position}}]));
    for x in [0.0, 3.0] {
        file.node(json!({"mesh": 0, "translation": [x - 1e6, 0.0, 0.0]}));
    }
    let loaded = file.load().unwrap();
    assert!(loaded.data.positions.iter().flatten().all(|x| x.abs() < 4.0), "{:?}", loaded.data.positions);
    assert_eq!(
        corners(&loaded, 1, 0).map(|p| p + loaded.origin.as_vec3()),
        TRIANGLE.map(|p| Vec3::from(p) + 3.0 * Vec3::X)
    );
}

#[test]
fn a_scene_far_from_zero_keeps_its_precision() {
    let mut file = Gltf::triangle();
    let small = TRIANGLE.map(|p| p.map(|x| x * 1e-3));
    file.bin.splice(0..36, bytemuck::cast_slice(&small).iter().copied());
    file.json["nodes"][0]["translation"] = json!([1e7, -1e7, 3e6]);
    let loaded = file.load().unwrap();
    let [a, b, c] = corners(&loaded, 0, 0);
    assert!(a.length() < 4e-3, "{a}");
    let error = ((b - a) - Vec3::X * 1e-3).length().max(((c - a) - Vec3::Y * 1e-3).length());
    assert!(error < 1e-9, "{error}");
    let world = a.as_dvec3() + loaded.origin;
    assert!(world.abs_diff_eq(DVec3::new(1e7, -1e7, 3e6), 1e-8), "{world}");
}

#[test]
fn normals_turn_by_the_inverse_transpose() {
    let mut file = Gltf::triangle();
    let n = Vec3::new(1.0, 1.0, 0.0).normalize().to_array();
    let normal = file.vec3(&[n; 3]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normal);
    file.json["nodes"][0]["scale"] = json!([-2, 1, 1]);
    let loaded = file.load().unwrap();
    let expected = Vec3::new(-0.5, 1.0, 0.0).normalize();
    for code in loaded.data.triangle_shading[0].normals {
        assert!(octahedral_decode(code).abs_diff_eq(expected, 1e-4));
    }
}

#[test]
fn normals_of_an_instance_stay_in_its_own_space() {
    let mut file = Gltf::triangle();
    let normal = file.vec3(&[[0.0, 0.0, 1.0]; 3]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normal);
    file.json["nodes"][0]["scale"] = json!([-2, 1, 1]);
    file.node(json!({"mesh": 0}));
    let loaded = file.load().unwrap();
    assert_eq!(loaded.data.triangle_shading[0].normals.map(octahedral_decode), [Vec3::Z; 3]);
}

#[test]
fn normals_without_direction_fall_back_to_the_triangle() {
    for bad in [0.0, f32::NAN, f32::INFINITY] {
        let mut file = Gltf::triangle();
        let normal = file.vec3(&[[0.0, 0.0, 1.0], [bad; 3], [0.0, 0.0, 1.0]]);
        file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normal);
        let loaded = file.load().unwrap();
        assert!(loaded.data.triangle_shading[0].is_flat());
        assert!(warned(&loaded, "no direction").is_some());
    }
}

#[test]
fn quantised_and_interleaved_vertices() {
    let mut file = Gltf::new();
    file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    // Three vertices of 12 bytes: position 3 × i16, two bytes of padding, normal 3 × i8, padding.
    let mut bytes = Vec::new();
    for p in TRIANGLE {
        bytes.extend(p.iter().flat_map(|&x| (x as i16 * 32767).to_le_bytes()));
        bytes.extend([0, 0, 0, 0, 127, 0]);
    }
    let view = file.view(&bytes);
    file.json["bufferViews"][view]["byteStride"] = json!(12);
    let mut attribute = |component: u32, offset: usize| {
        file.push(
            "accessors",
            json!({"bufferView": view, "componentType": component, "type": "VEC3", "count": 3,
            "normalized": true, "byteOffset": offset}),
        )
    };
    let (position, normal) = (attribute(I16, 0), attribute(I8, 8));
    file.mesh(json!([{"attributes": {"POSITION": position, "NORMAL": normal}}]));
    file.node(json!({"mesh": 0}));
    let loaded = file.load().unwrap();
    assert_eq!(corners(&loaded, 0, 0), TRIANGLE.map(Vec3::from));
    assert_eq!(loaded.data.triangle_shading[0].normals.map(octahedral_decode), [Vec3::Z; 3]);
}

#[test]
fn vertices_shared_by_primitives_are_stored_once() {
    let mut file = Gltf::new();
    let position = file.vec3(&SQUARE);
    let (a, b) = (file.indices(&[0, 1, 2]), file.indices(&[0, 2, 3]));
    file.mesh(json!([
        {"attributes": {"POSITION": position}, "indices": a},
        {"attributes": {"POSITION": position}, "indices": b},
    ]));
    file.node(json!({"mesh": 0}));
    let loaded = file.load().unwrap();
    assert_eq!(loaded.data.positions.len(), 4);
    assert_eq!(loaded.data.indices, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn a_flattening_scale_is_baked_with_its_normal() {
    let mut file = Gltf::triangle();
    let normal = file.vec3(&[[0.0, 0.6, 0.8]; 3]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normal);
    file.json["nodes"][0]["scale"] = json!([1, 1, 0]);
    file.node(json!({"mesh": 0, "scale": [0, 0, 0]}));
    let loaded = file.load().unwrap();
    assert_eq!((loaded.info.triangles, loaded.info.instances, loaded.info.degenerate), (2, 1, 1));
    assert_eq!(loaded.data.triangle_shading[0].normals.map(octahedral_decode), [Vec3::Z; 3]);
    assert!(loaded.data.triangle_shading[1].is_flat());
}

#[test]
fn only_the_default_scene_is_shown() {
    let mut file = Gltf::triangle();
    file.json["scenes"] = json!([{"nodes": [0]}, {"nodes": [1]}]);
    file.json["scene"] = json!(1);
    file.push("nodes", json!({"mesh": 0, "translation": [5, 0, 0]}));
    let loaded = file.load().unwrap();
    assert_eq!(loaded.info.extent[0][0], 5.0);
    assert!(warned(&loaded, "other scenes").is_some());
}

#[test]
fn the_same_file_gives_the_same_lists() {
    let mut file = Gltf::triangle();
    file.node(json!({"mesh": 0, "rotation": [0.1, 0.2, 0.3, 0.9]}));
    let extra = file.accessor(bytemuck::cast_slice(&SQUARE), F32, "VEC3", 4);
    file.mesh(json!([{"attributes": {"POSITION": extra}, "mode": 6}]));
    file.node(json!({"mesh": 1, "scale": [1e-4, 1e4, 3]}));
    assert_eq!(file.load().unwrap().data, file.load().unwrap().data);
}
