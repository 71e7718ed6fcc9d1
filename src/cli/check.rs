//! `check`: loads a scene and a camera path, and says what is there and what is wrong with the move.

use super::job_args::{InputArguments, ThreadsArgument};
use super::outcome::{Failure, Status, warn};
use super::values::parse_distance;
use crate::camera_formats::load_camera_path;
use crate::input::{InputFiles, load_scene};
use crate::job::pool;
use crate::preflight::preflight;
use clap::Args;
use glam::DVec3;
use std::io::Write;

/// Check a scene and a camera path, render nothing
///
/// Loads both, prints a summary, and warns of likely mistakes of the path, with frame numbers: where the camera is
/// inside a solid object, crosses a surface or is too close to one, where its speed spikes, where its velocity or
/// angular velocity jumps, where the image moves so fast that it strobes, where look_at makes the picture spin, and
/// whether a closed path has a seam.
///
/// Exit status: 0 both can be rendered, whatever the warnings; 2 wrong input or usage.
#[derive(Debug, Args)]
pub(super) struct CheckArguments {
    #[command(flatten)]
    input: InputArguments,
    /// The distance in metres that the camera should keep from surfaces
    #[arg(long, value_name = "METRES", default_value = "0.1", value_parser = parse_distance)]
    near: f64,
    #[command(flatten)]
    threads: ThreadsArgument,
}

pub(super) fn run(arguments: &CheckArguments) -> Result<Status, Failure> {
    let mut files = InputFiles::default();
    let path = load_camera_path(&arguments.input.path, &mut files)?;
    let input = load_scene(&arguments.input.scene, &mut files)?;
    let scene = &input.scene;
    let settings = path.settings.or(input.settings);
    settings.check_together()?;
    let resolved = settings.resolve(1);

    let mut out = std::io::stdout().lock();
    writeln!(out, "scene      {}", arguments.input.scene.display())?;
    writeln!(out, "objects    {}", input.object_count)?;
    writeln!(out, "triangles  {}", scene.triangle_count())?;
    writeln!(out, "spheres    {}", scene.sphere_count())?;
    writeln!(out, "lights     {}", scene.lights.len())?;
    writeln!(out, "textures   {}", scene.textures().len())?;
    for (texture, file) in scene.textures().iter().zip(&input.texture_files) {
        let (width, height) = texture.size();
        writeln!(out, "           {width}x{height} {}", file.display())?;
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
    writeln!(out, "path       {}", arguments.input.path.display())?;
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
    writeln!(out, "size       {}x{}", resolved.width, resolved.height)?;
    let (width, height) = (resolved.width, resolved.height);
    let pool = pool(arguments.threads.threads)?;
    let near = arguments.near;
    let of_path = pool.install(|| preflight(scene, &path.path, width, height, near));
    let of_path = of_path.iter().map(|warning| warning.to_string());
    let warnings: Vec<String> = input.warnings.iter().cloned().chain(of_path).collect();
    warn(&warnings);
    writeln!(out, "warnings   {}", warnings.len())?;
    Ok(Status::Done)
}

/// A point to four digits after the point, without needless zeros.
fn rounded(point: DVec3) -> String {
    let [x, y, z] = point.to_array().map(|c| (c * 1e4).round() / 1e4 + 0.0);
    format!("({x}, {y}, {z})")
}
