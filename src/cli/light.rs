use super::loading::Loaded;
use super::progress::{ShareProgress, clock};
use super::{Failure, warn};
use crate::bake::CacheFile;
use crate::bake::{BakeState, Baked, bake};
use crate::render::{ErrorEstimate, PixelSampling, RenderSettings};
use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

/// The file that the light is kept in.
pub(super) enum LightStore {
    /// One that other paths share: what it holds of them stays.
    Shared(PathBuf),
    /// One of this path alone: what it holds of others does not count, so that the light is that of a first run.
    Own(PathBuf),
    /// None.
    Nowhere,
}

/// The light of a path, as far as a file holds it already.
pub(super) struct PathLight {
    file: Option<CacheFile>,
    found: Option<BakeState>,
    /// What the path is called there.
    name: String,
}

impl PathLight {
    /// Opens the file, for frames of these settings.
    pub(super) fn open(
        store: LightStore,
        loaded: &Loaded,
        settings: &RenderSettings,
        force: bool,
    ) -> Result<PathLight, Failure> {
        // Only where the error decides on the light what it is measured by does, too.
        let target = settings.target_error.map(|target| {
            let is_spread = matches!(settings.sampling, PixelSampling::Spread(_));
            (target, settings.display_white, is_spread)
        });
        let decisive = format!(
            "{} {} {}x{} {target:?} {}",
            settings.integrator.bounces(),
            settings.seed,
            settings.width,
            settings.height,
            env!("CARGO_PKG_VERSION")
        );
        let mut fingerprint = blake3::Hasher::new();
        fingerprint.update(loaded.scene_fingerprint.as_bytes());
        fingerprint.update(decisive.as_bytes());
        let name = loaded.path_fingerprint.to_string();
        let (file, found) = match store {
            LightStore::Shared(file) => {
                let file = CacheFile::new(&file, fingerprint.finalize());
                let found = file.read(force)?;
                (Some(file), found)
            }
            LightStore::Own(file) => {
                let file = CacheFile::new(&file, fingerprint.finalize());
                // What is of no use is written over.
                let found = file.read(true).ok().flatten();
                let of_path = found.filter(|found| *found.paths() == [name.clone()]);
                (Some(file), of_path)
            }
            LightStore::Nowhere => (None, None),
        };
        Ok(PathLight { file, found, name })
    }

    /// The names of all paths that the light will be of, in the order in which they were added: it depends on
    /// them.
    pub(super) fn paths(&self) -> Vec<String> {
        let mut paths = self
            .found
            .as_ref()
            .map_or(Vec::new(), |c| c.paths().to_vec());
        if !paths.contains(&self.name) {
            paths.push(self.name.clone());
        }
        paths
    }

    /// Works out what is missing, keeps it, and says what it took.
    pub(super) fn bake(
        self,
        loaded: &Loaded,
        settings: &RenderSettings,
        quiet: bool,
    ) -> Result<Baked, Failure> {
        let has_all =
            |cache: &BakeState| cache.errors(&self.name, settings.display_white).is_some();
        let is_complete = self.found.as_ref().is_some_and(has_all);
        let file = self.file.filter(|_| !is_complete);
        if let Some(file) = &file {
            file.check_writable()?;
        }
        let start = Instant::now();
        let progress = ShareProgress::new(quiet);
        let listener = |share, what| progress.at(share, what);
        let (scene, path) = (&loaded.scene.scene, &loaded.path.path);
        let work = || bake(scene, path, &self.name, settings, self.found, &listener);
        let baked = loaded.pool.install(work);
        progress.finish();
        if let Some(file) = file {
            file.write(&baked.state)?;
        }
        if !quiet {
            let what = match is_complete {
                true => "read",
                false => "worked out",
            };
            let mut out = std::io::stdout();
            // Nobody has to read it.
            let _ = writeln!(
                out,
                "light of the path {what} in {}",
                clock(start.elapsed())
            );
            let _ = writeln!(out, "{}", summary(&baked));
        }
        if let Some(warning) = shortfall(&baked, settings.target_error) {
            warn(&[warning]);
        }
        Ok(baked)
    }
}

/// How much light there is, and its error.
fn summary(baked: &Baked) -> String {
    let mut summary = String::new();
    let [visible, secondary] = baked.cache.place_count();
    let megabytes = baked.cache.memory() as f64 / 1e6;
    summary += &format!(
        "  {visible} places that the camera sees, {secondary} beyond, {megabytes:.1} MB in memory"
    );
    let errors = || (0..).zip(baked.errors.iter());
    let of = |error: &ErrorEstimate| error.relative_square_error;
    if let Some((frame, worst)) = errors().max_by(|a, b| of(a.1).total_cmp(&of(b.1))) {
        let mean = errors().map(|(_, e)| of(e)).sum::<f64>() / errors().count() as f64;
        let [low, high] = worst.interval();
        summary += &format!(
            "\n  error of the light (relMSE) {mean:.2e} on average, at worst {:.2e} ({low:.2e} to {high:.2e}) \
             around frame {frame}",
            of(worst)
        );
    }
    summary
}

/// What to say of light that is not good enough.
fn shortfall(baked: &Baked, target_error: Option<f64>) -> Option<String> {
    let target = target_error.filter(|_| !baked.reaches_target)?;
    let errors = baked.errors.iter();
    let worst = errors.map(|error| error.interval()[1]).fold(0.0, f64::max);
    Some(format!(
        "the light of the path leaves too little room for the error of {target}: its own may be up to {worst:.2e}; \
         --gi path-traced has no such limit"
    ))
}
