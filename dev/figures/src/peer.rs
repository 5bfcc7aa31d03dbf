//! What a user would pick instead: a few samples a pixel and Open Image Denoise, as measured by the peers' scripts.

use std::path::Path;

use serde_json::Value;

use crate::subject;

/// One setting of the peer on one scene.
#[derive(Clone, Debug, PartialEq)]
pub struct PeerRow {
    scene: String,
    /// Samples a pixel.
    pub spp: f64,
    /// CPU-seconds of rendering and denoising.
    pub cpu_s: f64,
    /// relMSE of the denoised picture.
    pub relmse: f64,
    /// The same without the worst 0.1 % of pixels.
    pub trimmed: f64,
    /// Mean LDR-FLIP.
    pub flip: f64,
}

/// The peer's errors at some CPU-seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peer {
    /// relMSE.
    pub relmse: f64,
    /// relMSE without the worst 0.1 % of pixels.
    pub trimmed: f64,
    /// Mean LDR-FLIP.
    pub flip: f64,
    /// CPU-seconds it stands for: those asked for, or the nearest that were measured.
    pub cpu_s: f64,
}

/// Reads the script's JSON lines, or the references' table without a file.
pub fn read(file: Option<&Path>) -> Result<Vec<PeerRow>, String> {
    let (file, parse): (_, fn(&str) -> Option<PeerRow>) = match file {
        Some(file) => (file.to_owned(), json_row),
        None => (subject::shared()?.join("refs/README.md"), table_row),
    };
    let text = std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    let rows: Vec<_> = text.lines().filter_map(parse).collect();
    if rows.is_empty() { Err(format!("{}: holds no figures of the peer", file.display())) } else { Ok(rows) }
}

/// `{"scene": "NAME.gltf", "spp": 1, "total_cpu_s": …, "relmse": …, "relmse_trimmed": …, "flip_ldr": …}`
fn json_row(line: &str) -> Option<PeerRow> {
    let row: Value = serde_json::from_str(line).ok()?;
    let number = |key: &str| row[key].as_f64();
    Some(PeerRow {
        scene: row["scene"].as_str()?.trim_end_matches(".gltf").to_owned(),
        spp: number("spp")?,
        cpu_s: number("total_cpu_s")?,
        relmse: number("relmse")?,
        trimmed: number("relmse_trimmed")?,
        flip: number("flip_ldr")?,
    })
}

/// `| scene | spp | render + denoise = total | relMSE noisy | relMSE denoised | trimmed | FLIP |`
fn table_row(line: &str) -> Option<PeerRow> {
    let cells: Vec<&str> = line.trim().trim_matches('|').split('|').map(str::trim).collect();
    let [scene, spp, cpu_s, _, relmse, trimmed, flip] = cells[..] else { return None };
    let (_, total) = cpu_s.split_once('=')?;
    Some(PeerRow {
        scene: scene.to_owned(),
        spp: spp.parse().ok()?,
        cpu_s: total.trim().parse().ok()?,
        relmse: relmse.parse().ok()?,
        trimmed: trimmed.parse().ok()?,
        flip: flip.parse().ok()?,
    })
}

/// The peer's errors on a scene at `cpu_s`, between its measured settings on straight lines in logarithms; at its
/// cheapest or dearest one beyond them.
pub fn at(rows: &[PeerRow], scene: &str, cpu_s: f64) -> Option<Peer> {
    let mut rows: Vec<_> = rows.iter().filter(|row| row.scene == scene).collect();
    rows.sort_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s));
    let (first, last) = (*rows.first()?, *rows.last()?);
    let cpu_s = cpu_s.clamp(first.cpu_s, last.cpu_s);
    let next = rows.partition_point(|row| row.cpu_s < cpu_s).clamp(1, rows.len().max(2) - 1).min(rows.len() - 1);
    let (a, b) = (rows[next.saturating_sub(1)], rows[next]);
    let span = (b.cpu_s / a.cpu_s).ln();
    let t = if span > 0.0 { (cpu_s / a.cpu_s).ln() / span } else { 0.0 };
    let blend = |from: f64, to: f64| from * (to / from).powf(t);
    Some(Peer {
        relmse: blend(a.relmse, b.relmse),
        trimmed: blend(a.trimmed, b.trimmed),
        flip: blend(a.flip, b.flip),
        cpu_s,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: &str = "| cornell-box | 4 | 0.91 + 0.39 = 1.30 | 0.0643 | 0.0012 | 0.0005 | 0.038 |";

    #[test]
    fn rows_are_read() {
        let row = table_row(LINE).unwrap();
        assert_eq!(
            (row.scene.as_str(), row.spp, row.cpu_s, row.relmse, row.flip),
            ("cornell-box", 4.0, 1.3, 0.0012, 0.038)
        );
        assert_eq!(table_row("| scene | spp | CPU-s | relMSE noisy | relMSE denoised | trimmed | FLIP |"), None);
        assert_eq!(table_row("|---|---|---|---|---|---|---|"), None);
        let json = r#"{"scene":"cornell-box.gltf","spp":4,"total_cpu_s":1.3,"relmse":0.0012,"relmse_trimmed":0.0005,"flip_ldr":0.038}"#;
        assert_eq!(json_row(json), Some(row));
        assert_eq!(json_row("{}"), None);
    }

    #[test]
    fn between_settings_lines_in_logarithms() {
        let row = |cpu_s, relmse| PeerRow { scene: "a".into(), spp: 1.0, cpu_s, relmse, trimmed: relmse, flip: relmse };
        let rows = [row(4.0, 0.01), row(1.0, 0.04), row(16.0, 0.01)];
        let relmse = |cpu_s| at(&rows, "a", cpu_s).unwrap().relmse;
        for (cpu_s, expected) in [(0.1, 0.04), (1.0, 0.04), (2.0, 0.02), (4.0, 0.01), (8.0, 0.01), (99.0, 0.01)] {
            assert!((relmse(cpu_s) - expected).abs() < 1e-12, "{cpu_s}: {}", relmse(cpu_s));
        }
        assert_eq!(at(&rows, "b", 1.0), None);
        assert!((at(&rows[..1], "a", 1.0).unwrap().relmse - 0.01).abs() < 1e-12);
    }
}
