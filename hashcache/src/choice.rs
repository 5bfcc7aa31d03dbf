//! Settings that take one of a few names. A value that is not built does not exist here.

/// One of a closed list of names.
pub trait Choice: Copy + PartialEq + 'static {
    /// All values with their names, the default first.
    const ALL: &'static [(&'static str, Self)];

    /// The value's name.
    fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, value)| *value == self).map_or("", |(name, _)| name)
    }

    /// The value of a name.
    ///
    /// # Errors
    /// The names that exist.
    fn parse(name: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(known, _)| *known == name);
        found.map(|(_, value)| *value).ok_or_else(|| Self::names().join(", "))
    }

    /// All names, the default first.
    fn names() -> Vec<&'static str> {
        Self::ALL.iter().map(|(name, _)| *name).collect()
    }
}

macro_rules! choice {
    ($(#[$doc:meta])* $type:ident { $($(#[$value_doc:meta])* $value:ident = $name:literal),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $type {
            $($(#[$value_doc])* $value),*
        }

        impl Choice for $type {
            const ALL: &'static [(&'static str, Self)] = &[$(($name, Self::$value)),*];
        }
    };
}

choice! {
    /// Where kernels run.
    BackendKind {
        /// The processor.
        Cpu = "cpu",
    }
}
choice! {
    /// How light is transported.
    IntegratorKind {
        /// Path tracing with next-event estimation.
        Path = "path",
    }
}
choice! {
    /// Where light is shared between paths.
    CacheKind {
        /// The linkless octree of occupied cells (Roth et al. 2020).
        Octree = "octree",
        /// The jittered spatial hash of path vertices (Binder et al., path space filtering).
        Grid = "grid",
        /// Nowhere: each pixel has its own paths only.
        None = "none",
    }
}
choice! {
    /// How shadow rays are answered.
    VisibilityKind {
        /// Each is traced.
        Exact = "exact",
    }
}
choice! {
    /// How the picture is filtered.
    FilterKind {
        /// Each bounce of light by itself, from the deepest to the one seen, each by its own guides (Roth et al. 2020).
        Layered = "layered",
        /// All light at once, by the guides of the surfaces seen.
        Screen = "screen",
        /// Not at all.
        None = "none",
    }
}
choice! {
    /// The denoiser behind the filter.
    DenoiserKind {
        /// A cross-bilateral filter with 24 sparse taps.
        CrossBilateral = "cross-bilateral",
        /// An edge-avoiding à-trous wavelet.
        ATrous = "a-trous",
    }
}
choice! {
    /// What an octree's cell stores.
    OctreeLayout {
        /// 48 bytes; means that do not drift, and their scatter.
        Exact = "exact",
        /// 24 bytes; half floats, which drift.
        Paper = "paper",
    }
}
choice! {
    /// Whether sums of whole paths also tell how these scatter.
    Moments {
        /// No.
        Off = "off",
        /// Yes.
        On = "on",
    }
}
choice! {
    /// How the CPU backend runs kernels.
    Launcher {
        /// On several threads.
        Rayon = "rayon",
        /// On the caller's thread.
        Serial = "serial",
    }
}
choice! {
    /// The curve between radiance and what a screen shows.
    ToneCurve {
        /// None: clipped at 1.
        Srgb = "srgb",
        /// A film's: shadows a little darker, bright light keeps its shape up to a radiance of 7 (Narkowicz 2016).
        Filmic = "filmic",
    }
}
choice! {
    /// Where a pixel's direct light comes from when there is a cache.
    DirectLight {
        /// From the cell, like all other light.
        Cached = "cached",
        /// From the pixel's own shadow rays.
        Traced = "traced",
    }
}
