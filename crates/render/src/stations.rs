//! The stations of a render that devices run, and one of something for each.

use crate::device::Device;
use std::str::FromStr;

/// A station that devices run, in the order of the walk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Station {
    /// Station 3: the first pass, which places VPLs.
    Place,
    /// Photons for caustics.
    Photons,
    /// Station 4: the light tree.
    Tree,
    /// Station 5: the second pass.
    Gather,
    /// Station 6: bloom and tone mapping.
    Develop,
}

impl Station {
    /// All stations, in order.
    pub const ALL: [Self; 5] = [Self::Place, Self::Photons, Self::Tree, Self::Gather, Self::Develop];

    /// Its name on the command line and in statistics.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Place => "place",
            Self::Photons => "photons",
            Self::Tree => "tree",
            Self::Gather => "gather",
            Self::Develop => "develop",
        }
    }
}

impl FromStr for Station {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|station| station.name() == text).ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            format!("`{text}` is not a station; expected one of {names}")
        })
    }
}

/// One of something for each station.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PerStation<T>([T; Station::ALL.len()]);

/// Which device runs which station.
pub type Stations<'a> = PerStation<&'a dyn Device>;

impl<T> PerStation<T> {
    /// The same for every station.
    pub fn all(value: T) -> Self
    where
        T: Clone,
    {
        Self(std::array::from_fn(|_| value.clone()))
    }

    /// Another value for one station.
    #[must_use]
    pub fn with(mut self, station: Station, value: T) -> Self {
        self.0[station as usize] = value;
        self
    }

    /// That of a station.
    pub fn at(&self, station: Station) -> &T {
        &self.0[station as usize]
    }

    /// All, in the stations' order.
    pub fn each(&self) -> &[T; Station::ALL.len()] {
        &self.0
    }

    /// What a function makes of each.
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> PerStation<U> {
        PerStation(self.0.each_ref().map(f))
    }
}

impl<T, E> PerStation<Result<T, E>> {
    /// All values, or the first error.
    pub fn transpose(self) -> Result<PerStation<T>, E> {
        let [place, photons, tree, gather, develop] = self.0;
        Ok(PerStation([place?, photons?, tree?, gather?, develop?]))
    }
}
