//! Which integrator computes a frame, as plain data.

use serde::{Deserialize, Serialize};

/// How the radiance along a camera ray is computed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum IntegratorSettings {
    /// Direct light, ambient light and mirrors (Whitted 1980). Uses random numbers for soft shadows only.
    Whitted {
        /// How often a ray may be reflected.
        bounces: u32,
    },
    /// Indirect diffuse light by path tracing in place of the ambient term (Kajiya 1986). Unbiased.
    PathTraced {
        /// The longest path, in bounces, diffuse and mirror alike; 0 is direct light only.
        bounces: u32,
        /// How many paths continue from each diffuse bounce, the first bounce first; 1 beyond the list.
        splits: Vec<u32>,
    },
    /// As path traced, but the indirect diffuse light at surfaces that the camera sees, directly and in mirrors, is
    /// interpolated from an irradiance cache (Ward et al. 1988).
    Cached {
        /// The longest path, in bounces.
        bounces: u32,
    },
}

impl IntegratorSettings {
    /// The longest path, in bounces.
    pub fn bounces(&self) -> u32 {
        match self {
            IntegratorSettings::Whitted { bounces }
            | IntegratorSettings::PathTraced { bounces, .. }
            | IntegratorSettings::Cached { bounces } => *bounces,
        }
    }

    /// Whether surfaces gather light from around them. Ray tracing looks at the sky only straight ahead and in mirrors.
    pub fn gathers(&self) -> bool {
        !matches!(self, IntegratorSettings::Whitted { .. }) && self.bounces() > 0
    }
}
