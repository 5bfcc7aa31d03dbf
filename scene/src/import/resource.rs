//! Reading what a file names: the file itself, files beside it, `data:` URIs.

use std::fs;
use std::io::Read as _;
use std::path::{Component, Path, PathBuf};

use base64::Engine as _;

use crate::error::{At, SceneError, brief, one_line};

/// Where the bytes of a URI are.
enum Target {
    File(PathBuf),
    Inline(Vec<u8>),
}

/// Finds what `uri` names. Files lie in the scene's folder or below it: an absolute path, a `..` or a URI with a
/// scheme would let a scene read (and show) anything that its viewer may read.
fn resolve(uri: &str, base: &Path) -> Result<Target, String> {
    if let Some(rest) = uri.strip_prefix("data:") {
        return inline(rest).map(Target::Inline);
    }
    let scheme = uri.split_once(':').map(|(scheme, _)| scheme);
    if scheme.is_some_and(|s| !s.is_empty() && s.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))) {
        return Err(format!("only relative paths are read, not {:?}", brief(uri)));
    }
    let decoded = percent_encoding::percent_decode_str(uri)
        .decode_utf8()
        .map_err(|_| format!("{:?} is not UTF-8", brief(uri)))?;
    let path = Path::new(decoded.as_ref());
    let inside = path.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    if !inside || decoded.contains('\0') {
        return Err(format!("leaves the scene's folder: {:?}", brief(uri)));
    }
    Ok(Target::File(base.join(path)))
}

/// Decodes what follows `data:`.
fn inline(rest: &str) -> Result<Vec<u8>, String> {
    let (header, body) = rest.split_once(',').ok_or("data: URI without a comma")?;
    if header.ends_with(";base64") {
        let body: Vec<u8> = percent_encoding::percent_decode_str(body).collect();
        let engine = base64::engine::general_purpose::GeneralPurpose::new(
            &base64::alphabet::STANDARD,
            base64::engine::general_purpose::NO_PAD
                .with_decode_padding_mode(base64::engine::DecodePaddingMode::Indifferent),
        );
        engine.decode(body).map_err(|e| format!("data: URI is not base64: {e}"))
    } else {
        Ok(percent_encoding::percent_decode_str(body).collect())
    }
}

/// Reads the whole of a regular file of at most `limit` bytes.
pub(crate) fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, SceneError> {
    let io = |e: &std::io::Error| At::read(path, e);
    // Asked before opening: opening a pipe would wait for its writer.
    let meta = fs::metadata(path).map_err(|e| io(&e))?;
    if !meta.is_file() {
        let reason = "it is not a regular file".to_owned();
        return Err(SceneError::Read { file: one_line(&path.to_string_lossy()), reason });
    }
    if meta.len() > limit {
        let name = path.to_string_lossy();
        let what = format!("{} bytes", meta.len());
        return Err(At { file: &name }.too_large("the whole file", what, limit, "max_bytes"));
    }
    let mut bytes = Vec::with_capacity(meta.len() as usize);
    // A file that grows meanwhile is cut at the limit rather than followed.
    fs::File::open(path).and_then(|f| f.take(limit).read_to_end(&mut bytes)).map_err(|e| io(&e))?;
    Ok(bytes)
}

/// The bytes that `uri` of the glTF file `file` stands for. `place` is the URI's JSON pointer.
pub(crate) fn read_uri(at: At, base: &Path, uri: &str, place: &str, limit: u64) -> Result<Vec<u8>, SceneError> {
    match resolve(uri, base) {
        Ok(Target::Inline(bytes)) => Ok(bytes),
        Ok(Target::File(path)) => read_file(&path, limit).map_err(|e| match e {
            SceneError::Read { reason, .. } => at.unsupported(
                place,
                format!("cannot be read ({reason}): {:?}", brief(uri)),
                "put the file beside the scene",
            ),
            other => other,
        }),
        Err(what) => Err(at.unsupported(place, what, "put the file into the scene's folder")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(uri: &str) -> Result<PathBuf, String> {
        match resolve(uri, Path::new("dir"))? {
            Target::File(path) => Ok(path),
            Target::Inline(_) => Err("inline".into()),
        }
    }

    #[test]
    fn relative_uris_stay_in_the_folder() {
        assert_eq!(file("a.bin").unwrap(), Path::new("dir/a.bin"));
        assert_eq!(file("./sub/my%20tex%C3%A9.png").unwrap(), Path::new("dir/./sub/my texé.png"));
        for uri in ["/etc/passwd", "../a.bin", "sub/../../a", "%2e%2e/a", "%2Fetc/passwd", "a%00b", "%ff"] {
            assert!(file(uri).is_err(), "{uri}");
        }
        for uri in ["http://example.org/a.bin", "file:///etc/passwd", "C:a"] {
            assert!(file(uri).unwrap_err().contains("only relative paths"), "{uri}");
        }
    }

    #[test]
    fn an_empty_uri_names_the_folder_which_is_no_file() {
        assert_eq!(file("").unwrap(), Path::new("dir/"));
        let error = read_uri(At { file: "a.gltf" }, Path::new("."), "", "/buffers/0/uri", 9).unwrap_err().to_string();
        assert!(error.contains("/buffers/0/uri") && error.contains("not a regular file"), "{error}");
    }

    #[test]
    fn data_uris() {
        assert_eq!(inline("application/octet-stream;base64,AAEC/w==").unwrap(), [0, 1, 2, 255]);
        assert_eq!(inline(";base64,AAEC/w").unwrap(), [0, 1, 2, 255]);
        assert_eq!(inline("text/plain,a%20b").unwrap(), b"a b");
        assert!(inline(";base64,!!").is_err());
        assert!(inline("no comma").is_err());
    }
}
