//! Keys for a material's layers: what is seen of a glossy one depends on the direction it is seen from.
//!
//! A [`Lobe`] adds to a vertex's key the layer that its light belongs to and a bin of the direction of the ray that
//! arrived, jittered by draws of its own. So one table holds a diffuse layer, which every direction shares, beside
//! glossy ones, which split it; and since each lobe goes with [`Params`] of its own, their cells may differ in size.
//!
//! ```
//! use hashcache_core::{counters::Counters, glam::Vec3, pack::octahedral_encode, record::VertexRecord};
//! use hashgrid::jitter::SALT_DEPOSIT;
//! use hashgrid::keyed::{claim_keyed, deposit_keyed, estimate_keyed};
//! use hashgrid::lobe::{Lobe, LobeSettings};
//! use hashgrid::{CELL_WORDS, Params, Settings, Table, Word};
//!
//! let params = Params::new(&Settings { jitter: 0.0, ..Settings::default() })?;
//! let glossy = Lobe::new(&LobeSettings { layer: 1, direction_bins: 5, jitter: 0.0 })?;
//! let storage = [const { Word::new(0) }; 64 * CELL_WORDS];
//! let table = Table::new(&storage, &params)?;
//! table.clear();
//! let from = |direction, light| VertexRecord {
//!     direct: [light; 4],
//!     direction: octahedral_encode(direction),
//!     flags: VertexRecord::VALID,
//!     ..bytemuck::Zeroable::zeroed()
//! };
//! let vertices = [from(Vec3::NEG_Z, 1.0), from(Vec3::X, 3.0)]; // one place, two views
//! let mut counters = Counters::default();
//! claim_keyed(&table, &vertices, |vertex| glossy.key(&params, vertex, SALT_DEPOSIT));
//! deposit_keyed(&table, &params, &vertices, |vertex| glossy.key(&params, vertex, SALT_DEPOSIT), &mut counters);
//! let key_of = |vertex: &VertexRecord, salt| glossy.key(&params, vertex, salt);
//! estimate_keyed(&table, &params, &vertices, key_of, &mut counters, |i, estimate| {
//!     assert_eq!((estimate.direct.x, estimate.samples), ([1.0, 3.0][i], 1));
//! });
//! # Ok::<(), hashcache_core::error::ParamError>(())
//! ```
//!
//! # Source
//! Binder et al. 2021, section 3.1.2.
//!
//! # Limits today
//! Claims and deposits are on the host (the keys have WGSL bodies), and nobody here splits light by layer: the records' illumination is that of a diffuse lobe.

use hashcache_core::error::ParamError;
use hashcache_core::hash::pcg3d;
use hashcache_core::pack::octahedral_decode_int;
use hashcache_core::record::VertexRecord;

use crate::jitter::{draw, normal_bin};
use crate::key::{Key, key};
use crate::params::{MAX_NORMAL_BINS, Params};

/// Largest layer: what two bits hold.
pub const MAX_LAYER: u32 = 3;

/// Salt of the draws that jitter directions: other ones than the positions'.
pub const SALT_DIRECTION: u32 = 0x1656_67b1;

/// What a lobe's keys hold beside those of [`crate::key::key`]. [`Lobe::new`] checks it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeSettings {
    /// Layer of the material, 0 to [`MAX_LAYER`].
    pub layer: u32,
    /// Bins of directions along an edge of a face of their cube, odd, up to [`MAX_NORMAL_BINS`]; 0 for light that does
    /// not depend on the direction.
    pub direction_bins: u32,
    /// Width of the directions' jitter in bins, 0 to 1, apart from that of position and normal.
    pub jitter: f32,
}

/// A layer and its directions, checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lobe {
    layer: u32,
    direction_bins: u32,
    direction_jitter: u32,
}

impl Lobe {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`ParamError::NotFinite`] or [`ParamError::OutOfRange`] with the setting's name; even `direction_bins` other than 0
    /// count as out of range.
    pub fn new(settings: &LobeSettings) -> Result<Self, ParamError> {
        let LobeSettings { layer, direction_bins, jitter } = *settings;
        ParamError::check_range("layer", f64::from(layer), 0.0, f64::from(MAX_LAYER))?;
        let max = f64::from(MAX_NORMAL_BINS);
        ParamError::check_range("direction_bins", f64::from(direction_bins), 0.0, max)?;
        if direction_bins != 0 && direction_bins.is_multiple_of(2) {
            let value = f64::from(direction_bins);
            return Err(ParamError::OutOfRange { name: "direction_bins", value, min: 0.0, max });
        }
        ParamError::check_range("jitter", f64::from(jitter), 0.0, 1.0)?;
        let direction_jitter = (jitter * 32_768.0 / direction_bins.max(1) as f32) as u32;
        Ok(Self { layer, direction_bins, direction_jitter })
    }

    /// [`crate::key::key`] with layer and direction.
    #[inline]
    pub fn key(&self, params: &Params, vertex: &VertexRecord, salt: u32) -> Option<Key> {
        let key = key(params, vertex, salt)?;
        Some(Key { attributes: key.attributes | self.attributes(params, vertex, salt), ..key })
    }

    /// What the lobe adds to [`Key::attributes`]: layer and direction.
    #[inline]
    pub fn attributes(&self, params: &Params, vertex: &VertexRecord, salt: u32) -> u32 {
        let layer = self.layer << 30;
        if self.direction_bins == 0 {
            return layer;
        }
        let random = pcg3d([vertex.seed, params.seed(), salt ^ SALT_DIRECTION]);
        let [u, v] = [random[0] >> 16, random[1] >> 16].map(|bits| draw(bits, self.direction_jitter));
        let bin = normal_bin(octahedral_decode_int(vertex.direction), u, v, self.direction_bins);
        layer | ((bin + 1) << 19)
    }
}
