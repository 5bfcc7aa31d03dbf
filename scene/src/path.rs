//! Camera moves.

use std::path::Path;

use glam::DVec3;
use serde::Deserialize;

use crate::error::{At, SceneError};
use crate::import::resource;
use crate::view::View;

/// A camera's move: a view and a factor on the scene's light for each of its frames.
///
/// Position, target, up vector and field of view run through the keys on Catmull–Rom curves over time; before the first
/// and after the last key the curve goes on straight, so two keys make a line. The light's factor runs on straight lines
/// between the keys: it never falls below 0. What all keys agree in stays as it is, to the bit.
///
/// # Source
/// Catmull & Rom 1974, for keys at any times as Barry & Goldman 1988 have it.
///
/// ```
/// use scene::glam::DVec3;
/// use scene::{CameraKey, CameraPath};
///
/// let key = |time, x| CameraKey {
///     time,
///     position: DVec3::new(x, 1.0, 5.0),
///     target: DVec3::new(x, 1.0, 0.0),
///     up: DVec3::Y,
///     fov_y: 0.8,
///     light: 1.0,
/// };
/// let path = CameraPath::new("dolly", vec![key(0.0, -1.0), key(2.0, 1.0)], 5)?;
/// let (view, light) = path.frame(1).expect("there are five frames");
/// assert_eq!((view.position.x, light), (-0.5, 1.0));
/// # Ok::<(), scene::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPath {
    name: String,
    keys: Vec<CameraKey>,
    frames: u32,
}

/// Where a camera is at one time of a [`CameraPath`].
///
/// # Units
/// Metres, y up, in the scene file's coordinates; the field of view in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraKey {
    /// Seconds from an origin of the path's own.
    pub time: f64,
    /// The pinhole.
    pub position: DVec3,
    /// What is in the picture's middle.
    pub target: DVec3,
    /// Shows upwards in the picture.
    pub up: DVec3,
    /// Vertical field of view, above 0, below π.
    pub fov_y: f64,
    /// Factor on all light of the scene, at least 0; 1 leaves it as it is.
    pub light: f64,
}

/// A path file as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PathFile {
    keys: Vec<KeyInFile>,
    frames: u32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct KeyInFile {
    time: f64,
    position: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    fov_y_deg: f64,
    #[serde(default = "unchanged")]
    light: f64,
}

/// The light's factor where a key names none.
fn unchanged() -> f64 {
    1.0
}

/// The most frames of a path: nine hours at thirty a second. Each is checked when the path is made.
const MOST_FRAMES: u32 = 1_000_000;

/// The longest path file that is read, in bytes: a hundred thousand keys.
const LONGEST_PATH_FILE: u64 = 1 << 24;

/// What a path file looks like.
const FORM: &str =
    r#"write {"keys":[{"time":0,"position":[x,y,z],"target":[x,y,z],"up":[0,1,0],"fov_y_deg":45}, …],"frames":30}"#;

impl CameraPath {
    /// A path through `keys`, in the order of their times. `name` is what errors and views are called by.
    ///
    /// # Errors
    /// [`SceneError::Unsupported`]: no keys, times that do not grow, a number that is not finite, no frames or more than
    /// a million, a negative light factor, or a frame (or key) without a valid view.
    pub fn new(name: &str, keys: Vec<CameraKey>, frames: u32) -> Result<Self, SceneError> {
        let at = At { file: name };
        let path = Self { name: name.to_owned(), keys, frames };
        path.check().map_err(|(place, what)| at.unsupported(place, what, FORM))?;
        Ok(path)
    }

    /// Reads a path file: `{"keys":[{"time":s,"position":[x,y,z],"target":[x,y,z],"up":[x,y,z],"fov_y_deg":θ}],"frames":N}`,
    /// in metres, seconds and degrees. A key may also hold `"light"`, a factor on the scene's light, 1 where it is absent.
    ///
    /// # Errors
    /// [`SceneError::Read`], [`SceneError::TooLarge`] above 16 MiB, or [`SceneError::Unsupported`] with the JSON pointer
    /// of what is wrong.
    ///
    /// ```
    /// let dir = tempfile::tempdir()?;
    /// let file = dir.path().join("still.json");
    /// let key = r#"{"time":0,"position":[0,1,5],"target":[0,1,0],"up":[0,1,0],"fov_y_deg":45,"light":0.5}"#;
    /// std::fs::write(&file, format!(r#"{{"keys":[{key}],"frames":10}}"#))?;
    /// let path = scene::CameraPath::from_file(&file)?;
    /// assert_eq!(path.frames(), 10);
    /// let (view, light) = path.frame(9).expect("the last of ten");
    /// assert_eq!((view.name.as_str(), view.position.z, light), ("still", 5.0, 0.5));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn from_file(path: &Path) -> Result<Self, SceneError> {
        let file = path.to_string_lossy();
        let at = At { file: &file };
        let bytes = resource::read_file(path, LONGEST_PATH_FILE)?;
        let read: PathFile = serde_json::from_slice(&bytes).map_err(|e| at.json("a camera path", &e, FORM))?;
        let name = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        let keys = read.keys.iter().map(CameraKey::from).collect();
        let path = Self { name, keys, frames: read.frames };
        path.check().map_err(|(place, what)| at.unsupported(place, what, FORM))?;
        Ok(path)
    }

    /// How many frames there are, at least 1.
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// The keys, in the order of their times, at least 1.
    pub fn keys(&self) -> &[CameraKey] {
        &self.keys
    }

    /// The time of a frame: frames divide the time from the first to the last key evenly, both included. A path of one
    /// frame shows its first key, and frames beyond the last stay there.
    pub fn time(&self, frame: u32) -> f64 {
        let (first, last) = (self.keys[0].time, self.keys[self.keys.len() - 1].time);
        let steps = self.frames - 1;
        if frame == 0 || steps == 0 {
            first
        } else if frame >= steps {
            last
        } else {
            first + (last - first) * (f64::from(frame) / f64::from(steps))
        }
    }

    /// The view of a frame and the factor on the scene's light; `None` from [`CameraPath::frames`] on.
    pub fn frame(&self, frame: u32) -> Option<(View, f32)> {
        if frame >= self.frames {
            return None;
        }
        let key = self.at(self.time(frame));
        // The path's making has tried every frame.
        self.view(&key).ok().map(|view| (view, key.light as f32))
    }

    /// What is wrong and where.
    fn check(&self) -> Result<(), (String, String)> {
        if self.keys.is_empty() {
            return Err(("/keys".into(), "there is no key".into()));
        }
        if !(1..=MOST_FRAMES).contains(&self.frames) {
            return Err(("/frames".into(), format!("{} is not between 1 and {MOST_FRAMES}", self.frames)));
        }
        let mut before = f64::NEG_INFINITY;
        for (i, key) in self.keys.iter().enumerate() {
            let place = |field: &str| format!("/keys/{i}{field}");
            if !key.time.is_finite() {
                return Err((place("/time"), format!("{} is not finite", key.time)));
            }
            if key.time <= before {
                return Err((place("/time"), format!("{} is not after the key before, at {before}", key.time)));
            }
            if !(key.light >= 0.0 && key.light <= f64::from(f32::MAX)) {
                return Err((place("/light"), format!("{} is not a factor of at least 0", key.light)));
            }
            if !(key.fov_y > 0.0 && key.fov_y < std::f64::consts::PI) {
                let what = format!("{} is not between 0 and 180", key.fov_y.to_degrees());
                return Err((place("/fov_y_deg"), what));
            }
            self.view(key).map_err(|what| (place(""), what.to_owned()))?;
            before = key.time;
        }
        for frame in 0..self.frames {
            let key = self.at(self.time(frame));
            self.view(&key).map_err(|what| ("/keys".to_owned(), format!("frame {frame}, between keys: {what}")))?;
        }
        Ok(())
    }

    fn view(&self, key: &CameraKey) -> Result<View, &'static str> {
        View::look_at(self.name.clone(), key.position, key.target, key.up, key.fov_y)
    }

    /// The curve at a time between the first and the last key's.
    fn at(&self, time: f64) -> CameraKey {
        let next = self.keys.partition_point(|key| key.time <= time);
        if next == self.keys.len() {
            return self.keys[next - 1];
        }
        let start = next.saturating_sub(1);
        let (a, b) = (&self.keys[start], &self.keys[next]);
        let t = (time - a.time) / (b.time - a.time);
        let (from, to) = (a.curved(), b.curved());
        let (leave, arrive) = (self.slope(start), self.slope(next));
        let span = b.time - a.time;
        // Hermite's form, around the first key so that a difference of 0 changes no bit.
        let blend = |c: usize| {
            let (s, rest) = (t * t * (3.0 - 2.0 * t), 1.0 - t);
            from[c] + (to[c] - from[c]) * s + span * t * rest * (leave[c] * rest - arrive[c] * t)
        };
        let light = a.light + (b.light - a.light) * t;
        CameraKey::from_curved(time, std::array::from_fn(blend), light)
    }

    /// The curve's derivative at a key: that of the parabola through it and its neighbours; of the line at an end.
    fn slope(&self, i: usize) -> [f64; CURVED] {
        let line = |i: usize| {
            let (a, b) = (&self.keys[i], &self.keys[i + 1]);
            let (from, to, span) = (a.curved(), b.curved(), b.time - a.time);
            (std::array::from_fn::<f64, CURVED, _>(|c| (to[c] - from[c]) / span), span)
        };
        let last = self.keys.len() - 1;
        if last == 0 {
            return [0.0; CURVED];
        }
        if i == 0 || i == last {
            return line(if i == 0 { 0 } else { last - 1 }).0;
        }
        let ((before, earlier), (after, later)) = (line(i - 1), line(i));
        let weight = earlier / (earlier + later);
        std::array::from_fn(|c| before[c] + (after[c] - before[c]) * weight)
    }
}

/// Numbers that run on curves: position, target, up vector, field of view.
const CURVED: usize = 10;

impl CameraKey {
    fn curved(&self) -> [f64; CURVED] {
        let (p, t, u) = (self.position, self.target, self.up);
        [p.x, p.y, p.z, t.x, t.y, t.z, u.x, u.y, u.z, self.fov_y]
    }

    fn from_curved(time: f64, c: [f64; CURVED], light: f64) -> Self {
        Self {
            time,
            position: DVec3::new(c[0], c[1], c[2]),
            target: DVec3::new(c[3], c[4], c[5]),
            up: DVec3::new(c[6], c[7], c[8]),
            fov_y: c[9],
            light,
        }
    }
}

impl From<&KeyInFile> for CameraKey {
    fn from(key: &KeyInFile) -> Self {
        let [position, target, up] = [key.position, key.target, key.up].map(DVec3::from_array);
        Self { time: key.time, position, target, up, fov_y: key.fov_y_deg.to_radians(), light: key.light }
    }
}
