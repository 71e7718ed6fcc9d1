//! Bakes the irradiance cache of a camera path, before its first frame.
//!
//! 1. Views: how closely the frames see each surface at most.
//! 2. Placement: records in cells of space, as small as the closest view asks for where other surfaces are close.
//! 3. Gathering: path tracing gives the value of each record; paths end in secondary records, which are gathered as they
//!    are asked for. Where few paths find the light, more are traced.
//! 4. Gradients: a linear function is fitted to the values around each primary record.
//! 5. Validation: at held-out pixels the cache is compared with path tracing, which gives the cache error of each
//!    frame. Where it exceeds the target, all is baked again with more and smaller records.
//!
//! The result is a function of scene, path and settings: it does not depend on the number of threads, nor on which
//! frames are rendered with it.

mod add_camera_path;
mod bake_state;
mod cache_file;
mod candidates;
mod counter;
mod finest_view;
mod fit_gradients;
mod gather;
mod gathered_light;
mod keeper;
mod least_squares;
mod neighbours;
mod placement;
mod validation;

use crate::camera::CameraPath;
use crate::irradiance_cache::IrradianceCache;
use crate::render::{ErrorEstimate, RenderSettings};
use crate::scene::Scene;
use add_camera_path::GATHERED;
pub use add_camera_path::Listener;
pub use bake_state::BakeState;
pub use cache_file::{CacheFile, CacheFileError};
pub use keeper::{BakeKeeper, NoKeeper};
pub use validation::cache_errors;

/// The baked irradiance cache of a camera path and its error.
#[derive(Debug)]
pub struct Baked {
    /// What a file keeps for other runs.
    pub state: BakeState,
    /// What frames interpolate.
    pub cache: IrradianceCache,
    /// The cache error of each frame of the path; empty if there are no bounces.
    pub errors: Vec<ErrorEstimate>,
    /// The frames in which it [misses](RenderSettings::cache_misses) its part of the target error.
    pub missed: Vec<u32>,
}

/// Bakes the irradiance cache for all frames of a path, called `name`, of these settings, on the threads of the
/// current pool. A given state, of the same scene and settings, is extended by what this path lacks: what comes of it is the
/// same.
///
/// Of a target error the cache may take up half. If it takes up more, the records of the path are refined.
pub fn bake(
    scene: &Scene,
    path: &CameraPath,
    name: &str,
    settings: &RenderSettings,
    given: Option<BakeState>,
    listener: Listener,
) -> Baked {
    let Ok(baked) = bake_kept(scene, path, name, settings, given, listener, &mut NoKeeper);
    baked
}

/// As [`bake`], kept while it goes on.
pub fn bake_kept<Keeper: BakeKeeper>(
    scene: &Scene,
    path: &CameraPath,
    name: &str,
    settings: &RenderSettings,
    given: Option<BakeState>,
    listener: Listener,
    keeper: &mut Keeper,
) -> Result<Baked, Keeper::Error> {
    let bounces = settings.integrator.bounces();
    let mut state = given.unwrap_or_else(|| BakeState::new(bounces, settings.seed));
    let mut level = state.refinement_level(name);
    loop {
        let refinement_level = level.unwrap_or(0);
        if level.is_none() || state.refinement_level(name) != level {
            let size = (settings.width, settings.height);
            state.add_camera_path(scene, path, name, size, refinement_level, listener, keeper)?;
        }
        listener(GATHERED, "cache error");
        let cache = state
            .irradiance_cache(scene, name)
            .expect("the path is there");
        let errors = match state.errors(name, settings.display_white) {
            Some(errors) => errors.to_vec(),
            None => {
                let errors = cache_errors(scene, path, settings, &cache)
                    .expect("the cache is of the settings' bounces");
                state.set_errors(name, settings.display_white, &errors);
                errors
            }
        };
        let misses = |(_, error): &(u32, &ErrorEstimate)| settings.cache_misses(error);
        let missed = (0..).zip(&errors).filter(misses).map(|(frame, _)| frame);
        let missed: Vec<u32> = missed.collect();
        if missed.is_empty() || refinement_level == BakeState::MAX_REFINEMENT {
            return Ok(Baked {
                state,
                cache,
                errors,
                missed,
            });
        }
        level = Some(refinement_level + 1);
    }
}
