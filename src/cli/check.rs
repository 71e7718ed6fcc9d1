//! `check`: loads a scene and a camera path, and says what is there and what is likely to be wrong.

use super::job_args::{InputArguments, SettingsArguments, ThreadsArgument};
use super::outcome::{Failure, Status, warn};
use super::values::parse_distance;
use crate::job::{Job, JobOptions, Spec};
use crate::text::visible;
use clap::Args;
use glam::DVec3;
use std::io::Write;
use std::path::Path;

/// The distance in metres that the camera should keep from surfaces, unless another is given.
pub(super) const NEAR: f64 = 0.1;

/// Check a scene and a camera path, render nothing
///
/// Loads both, prints a summary, and warns of likely mistakes, as `render` does before it starts.
///
/// Of the settings: those that make no difference in the mode. Of the scene: no light, lights of intensity 0, lights in
/// closed bodies that the camera never enters, materials that reflect more light than they get, shapes that are there
/// twice, and surfaces that overlap in one plane where the camera sees them (z-fighting).
///
/// Of the path, with frame numbers: where the camera sees nothing, is inside a solid object, crosses a surface or is
/// too close to one, where its speed spikes, where its velocity or angular velocity jumps, where the image moves so
/// fast that it strobes, where look_at makes the picture spin, whether a closed path has a seam, and whether keyframes
/// are closer than frames.
///
/// Exit status: 0 both can be rendered, whatever the warnings; 2 wrong input or usage.
#[derive(Debug, Args)]
pub(super) struct CheckArguments {
    #[command(flatten)]
    input: InputArguments,
    /// The distance in metres that the camera should keep from surfaces
    #[arg(long, value_name = "METRES", default_value_t = NEAR, value_parser = parse_distance)]
    near: f64,
    #[command(flatten)]
    settings: SettingsArguments,
    #[command(flatten)]
    threads: ThreadsArgument,
}

pub(super) fn run(arguments: &CheckArguments) -> Result<Status, Failure> {
    let spec = Spec {
        settings: arguments.settings.settings(),
        ..Spec::new(&arguments.input.scene, &arguments.input.path)
    };
    let options = JobOptions {
        threads: arguments.threads.threads,
        ..JobOptions::default()
    };
    let job = Job::new(spec, None, &options)?;
    let (input, path) = (&job.inputs().scene, &job.inputs().path);
    let scene = &input.scene;
    let settings = job.inputs().settings(job.spec().settings.clone());
    let (width, height) = (job.settings().width, job.settings().height);

    let mut out = std::io::stdout().lock();
    let file = |file: &Path| visible(file.display());
    writeln!(out, "scene      {}", file(&arguments.input.scene))?;
    writeln!(out, "objects    {}", input.object_count)?;
    writeln!(out, "triangles  {}", scene.triangle_count())?;
    writeln!(out, "spheres    {}", scene.sphere_count())?;
    writeln!(out, "lights     {}", scene.lights.len() + scene.suns.len())?;
    for group in scene.light_groups(&input.names) {
        writeln!(out, "           {group}")?;
    }
    writeln!(out, "textures   {}", scene.textures().len())?;
    for (texture, name) in scene.textures().iter().zip(&input.texture_files) {
        let (width, height) = texture.size();
        writeln!(out, "           {width}x{height} {}", file(name))?;
    }
    let bounds = scene.bounds();
    if scene.triangle_count() + scene.sphere_count() > 0 {
        let corner = |p: glam::Vec3| rounded(scene.origin + p.as_dvec3());
        writeln!(
            out,
            "bounds     {} to {}",
            corner(bounds.min),
            corner(bounds.max)
        )?;
    }
    writeln!(
        out,
        "memory     {:.1} MiB",
        scene.memory() as f64 / f64::from(1 << 20)
    )?;
    let timeline = path.path.timeline();
    let frames = timeline.frame_count();
    writeln!(out, "path       {}", file(&arguments.input.path))?;
    writeln!(out, "frames     {frames} at {} per second", timeline.fps)?;
    writeln!(out, "duration   {} s", timeline.end - timeline.start)?;
    let (first, last) = (path.path.camera(0), path.path.camera(frames - 1));
    writeln!(
        out,
        "camera     {} to {}",
        rounded(first.position),
        rounded(last.position)
    )?;
    writeln!(out, "mode       {}", settings.mode.unwrap_or_default())?;
    writeln!(out, "size       {width}x{height}")?;
    let all: Vec<u32> = (0..frames).collect();
    let warnings = job.warnings(arguments.near, &all);
    warn(&warnings);
    writeln!(out, "warnings   {}", warnings.len())?;
    Ok(Status::Done)
}

/// A point to four digits after the point, without needless zeros.
fn rounded(point: DVec3) -> String {
    let [x, y, z] = point.to_array().map(|c| (c * 1e4).round() / 1e4 + 0.0);
    format!("({x}, {y}, {z})")
}
