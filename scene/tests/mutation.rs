//! Random damage to a small GLB: no panic, no long wait, no large allocation.

mod common;
mod survive;

use proptest::prelude::*;
use survive::{SMALL, sample, survive_scene};

/// Loads the bytes; whatever they are, an answer comes soon and cheaply.
fn survive(bytes: &[u8]) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("scene.glb");
    std::fs::write(&path, bytes).unwrap();
    survive_scene(&path, SMALL);
}

/// Where the JSON's text ends.
fn text_end(file: &[u8]) -> usize {
    20 + u32::from_le_bytes([file[12], file[13], file[14], file[15]]) as usize
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_changed(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8)) {
        let mut file = sample().glb();
        for (index, value) in changes {
            let i = index.index(file.len());
            file[i] = value;
        }
        survive(&file);
    }

    #[test]
    fn any_digit_changed(changes in prop::collection::vec((any::<prop::sample::Index>(), b'0'..=b'9'), 1..6)) {
        let mut file = sample().glb();
        let digits: Vec<usize> = (20..text_end(&file)).filter(|&i| file[i].is_ascii_digit()).collect();
        for (index, value) in changes {
            file[digits[index.index(digits.len())]] = value;
        }
        survive(&file);
    }

    #[test]
    fn any_number_replaced(which in any::<prop::sample::Index>(), value in prop_oneof![
        Just("0"), Just("-1"), Just("1e300"), Just("4294967295"), Just("4294967296"), Just("18446744073709551615"),
        Just("0.5"), Just("null"), Just("[]"), Just("{}"), Just("\"\""), Just("1000000000"),
    ]) {
        let file = sample().glb();
        let text = std::str::from_utf8(&file[20..text_end(&file)]).unwrap();
        let starts: Vec<usize> = text.match_indices([':', '[', ',']).map(|(i, _)| i + 1)
            .filter(|&i| text[i..].starts_with(|c: char| c.is_ascii_digit())).collect();
        let start = starts[which.index(starts.len())];
        let length = text[start..].find(|c: char| !c.is_ascii_digit() && c != '.').unwrap();
        let mut json = format!("{}{value}{}", &text[..start], &text[start + length..]).into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut out = file[..20].to_vec();
        out.extend(&json);
        out.extend(&file[text_end(&file)..]);
        let total = out.len() as u32;
        out[8..12].copy_from_slice(&total.to_le_bytes());
        out[12..16].copy_from_slice(&(json.len() as u32).to_le_bytes());
        survive(&out);
    }

    #[test]
    fn any_piece_cut_out(from in any::<prop::sample::Index>(), length in 1_usize..200) {
        let mut file = sample().glb();
        let from = from.index(file.len());
        let to = (from + length).min(file.len());
        file.drain(from..to);
        survive(&file);
    }
}

#[test]
fn the_sample_itself_loads() {
    let loaded = sample().load().unwrap();
    assert_eq!((loaded.info.triangles, loaded.info.instances, loaded.cameras.len()), (9, 3, 1));
    assert_eq!((loaded.info.punctual_lights, loaded.info.images, loaded.info.surfaces.mask), ([1, 1, 1], 2, 1));
    assert!(!loaded.data.uv2.is_empty() && loaded.info.surfaces.coat == 1 && loaded.info.surfaces.unlit == 1);
    survive(&sample().glb());
}

/// Zlib data that unpack to 258 × `repeats` + 1 zeros, 13 bits for 258 of them.
fn bomb(repeats: usize) -> Vec<u8> {
    let mut bits = vec![1_u8, 1, 0];
    let mut huffman = |code: u16, length: u16| bits.extend((0..length).rev().map(|i| (code >> i & 1) as u8));
    // Literal 0; the last byte once more, 258 times; the end.
    huffman(0b0011_0000, 8);
    (0..repeats).for_each(|_| huffman(0b1_1000_1010_0000, 13));
    huffman(0, 7);
    let bytes = bits.chunks(8).map(|c| c.iter().rev().fold(0, |byte, bit| byte << 1 | bit));
    let sum: [u8; 4] = ((((258 * repeats + 1) % 65_521) as u32) << 16 | 1).to_be_bytes();
    [0x78, 0x01].into_iter().chain(bytes).chain(sum).collect()
}

/// A colour profile and a text that unpack to 256 MiB each stay packed.
#[test]
fn bombs_beside_the_pixels_are_not_unpacked() {
    let image = common::png(1, 1, &[1, 2, 3, 255]);
    let header = 8 + 12 + 13;
    let packed = bomb((256 << 20) / 258);
    for (kind, head) in [(*b"iCCP", &b"profile\0\0"[..]), (*b"zTXt", b"Comment\0\0")] {
        let mut bytes = image[..header].to_vec();
        common::png_chunk(&mut bytes, kind, &[head, &packed].concat());
        bytes.extend(&image[header..]);
        let mut file = common::Gltf::triangle();
        let view = file.view(&bytes);
        let image = serde_json::json!({"bufferView": view, "mimeType": "image/png"});
        file.textured_material(image, serde_json::json!({}), 0);
        file.json["meshes"][0]["primitives"][0]["material"] = serde_json::json!(0);
        survive(&file.glb());
        assert_eq!(file.load().unwrap().data.texels, [0xff03_0201]);
    }
}
