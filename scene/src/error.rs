//! What can go wrong, in one line each.

/// A scene, camera or environment that could not be loaded.
///
/// `Display` is always one line: where (file, then JSON pointer or place in it), what failed, what to do. Text that
/// comes from the file is escaped, so a name with a line break stays on that line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The operating system would not read a file.
    #[error("{file}: cannot be read: {reason}; check the path and its permissions")]
    Read {
        /// The file.
        file: String,
        /// The system's words.
        reason: String,
    },
    /// The file breaks its format's rules.
    #[error("{file}: {place}: {what}; export or download the file again")]
    Malformed {
        /// The file.
        file: String,
        /// JSON pointer, or the place in words where there is none.
        place: String,
        /// What is wrong there.
        what: String,
    },
    /// The file is valid, but needs something that is not supported.
    #[error("{file}: {place}: {what}; {advice}")]
    Unsupported {
        /// The file.
        file: String,
        /// JSON pointer, or the place in words where there is none.
        place: String,
        /// What is not supported.
        what: String,
        /// How to go on.
        advice: String,
    },
    /// The file asks for more memory than the options allow.
    #[error("{file}: {place}: {what}, the limit is {limit}; split the scene or raise LoadOptions::{option}")]
    TooLarge {
        /// The file.
        file: String,
        /// JSON pointer, or the place in words where there is none.
        place: String,
        /// How much of what is asked for.
        what: String,
        /// How much is allowed.
        limit: u64,
        /// The field of [`LoadOptions`](crate::LoadOptions) that allows it.
        option: &'static str,
    },
    /// There is not one triangle to see.
    #[error("{file}: holds no triangles; give a scene with at least one mesh of triangles in its default scene")]
    NoGeometry {
        /// The file.
        file: String,
    },
    /// A camera is needed and the scene has none.
    #[error("{scene}: holds no perspective camera; {}", pass(beside.as_deref()))]
    NoCamera {
        /// The scene.
        scene: String,
        /// A camera file that lies beside it.
        beside: Option<String>,
    },
    /// No camera of the scene has this name or index.
    #[error("{scene}: has no camera {name:?}; it has {known}")]
    UnknownCamera {
        /// The scene.
        scene: String,
        /// The name or index that was asked for.
        name: String,
        /// The cameras there are, by index and name.
        known: String,
    },
    /// There is no such built-in scene.
    #[error("builtin:{}: no such built-in scene; there are {known}", name.escape_debug())]
    UnknownBuiltin {
        /// The name that was asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// The source is neither a glTF file nor a built-in scene.
    #[error("{source_name}: neither .gltf, .glb nor builtin:NAME; give one of these")]
    UnknownFormat {
        /// What was given.
        source_name: String,
    },
    /// An argument has no meaning.
    #[error("{what}: {value} is out of range; give {expected}")]
    OutOfRange {
        /// The argument.
        what: &'static str,
        /// Its value.
        value: String,
        /// What is accepted.
        expected: &'static str,
    },
}

/// How to name a camera.
fn pass(beside: Option<&str>) -> String {
    beside.map_or_else(
        || "pass --camera FILE.json with position, target, up and fov_y_deg".into(),
        |file| format!("pass --camera {file}, which lies beside it, or another camera file"),
    )
}

/// `text` on one line: control characters are escaped.
pub(crate) fn one_line(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() || c == '\u{2028}' || c == '\u{2029}' {
            line.extend(c.escape_default());
        } else {
            line.push(c);
        }
    }
    line
}

/// `text` on one line and of a length that can be read; a name in a file may have megabytes.
pub(crate) fn brief(text: &str) -> String {
    const LONGEST: usize = 240;
    let end = text.char_indices().nth(LONGEST).map_or(text.len(), |(i, _)| i);
    let mut line = one_line(&text[..end]);
    if end < text.len() {
        line.push('…');
    }
    line
}

/// The file in hand, from which errors are made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct At<'a> {
    /// Its name as shown.
    pub file: &'a str,
}

impl At<'_> {
    /// A breach of the format's rules.
    pub fn malformed(self, place: impl AsRef<str>, what: impl AsRef<str>) -> SceneError {
        SceneError::Malformed { file: one_line(self.file), place: brief(place.as_ref()), what: brief(what.as_ref()) }
    }

    /// Something valid that is not supported.
    pub fn unsupported(self, place: impl AsRef<str>, what: impl AsRef<str>, advice: &str) -> SceneError {
        SceneError::Unsupported {
            file: one_line(self.file),
            place: brief(place.as_ref()),
            what: brief(what.as_ref()),
            advice: advice.to_owned(),
        }
    }

    /// More than the options allow.
    pub fn too_large(self, place: impl AsRef<str>, what: String, limit: u64, option: &'static str) -> SceneError {
        SceneError::TooLarge { file: one_line(self.file), place: brief(place.as_ref()), what, limit, option }
    }

    /// JSON that is not what it should be: `what` says what that is.
    pub fn json(self, what: &str, error: &serde_json::Error, advice: &str) -> SceneError {
        let text = error.to_string();
        // The place is given apart.
        let reason = text.rsplit_once(" at line ").map_or(text.as_str(), |(reason, _)| reason);
        let place = format!("line {}, column {}", error.line(), error.column());
        self.unsupported(place, format!("not {what}: {reason}"), advice)
    }

    /// A refusal by the operating system.
    pub fn read(file: &std::path::Path, error: &std::io::Error) -> SceneError {
        SceneError::Read { file: one_line(&file.to_string_lossy()), reason: one_line(&error.to_string()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_text_stays_on_one_line() {
        let at = At { file: "a\nb.gltf" };
        let errors = [
            at.malformed("/meshes\r/0", "line\u{2028}break"),
            at.unsupported("/x\ny", "z\u{1b}[31m", "do this"),
            at.too_large("/x\ny", "3 triangles".into(), 2, "max_triangles"),
            SceneError::UnknownBuiltin { name: "a\nb".into(), known: "cornell".into() },
        ];
        for error in errors {
            let text = error.to_string();
            assert_eq!(text.lines().count(), 1, "{text}");
            assert!(!text.chars().any(char::is_control), "{text:?}");
        }
    }
}
