use super::args::CheckArguments;
use super::{Failure, Status, warn};
use crate::input::{InputFiles, load_camera_path, load_scene};
use glam::DVec3;

pub(super) fn run(arguments: &CheckArguments) -> Result<Status, Failure> {
    let mut files = InputFiles::default();
    let path = load_camera_path(&arguments.path, &mut files)?;
    let input = load_scene(&arguments.scene, &mut files)?;
    let scene = &input.scene;
    let settings = path.settings.or(input.settings);
    let resolved = settings.resolve();

    println!("scene      {}", arguments.scene.display());
    println!("objects    {}", input.object_count);
    println!("triangles  {}", scene.triangle_count());
    println!("spheres    {}", scene.sphere_count());
    println!("lights     {}", scene.lights.len());
    println!("textures   {}", scene.textures().len());
    for (texture, file) in scene.textures().iter().zip(&input.texture_files) {
        let (width, height) = texture.size();
        println!("           {width}x{height} {}", file.display());
    }
    let bounds = scene.bounds();
    if scene.triangle_count() + scene.sphere_count() > 0 {
        let corner = |p: glam::Vec3| rounded(scene.origin + p.as_dvec3());
        println!(
            "bounds     {} to {}",
            corner(bounds.min),
            corner(bounds.max)
        );
    }
    println!(
        "memory     {:.1} MiB",
        scene.memory() as f64 / f64::from(1 << 20)
    );
    let timeline = path.path.timeline();
    let frames = timeline.frame_count();
    println!("path       {}", arguments.path.display());
    println!("frames     {frames} at {} per second", timeline.fps);
    println!("duration   {} s", timeline.end - timeline.start);
    let (first, last) = (path.path.camera(0), path.path.camera(frames - 1));
    println!(
        "camera     {} to {}",
        rounded(first.position),
        rounded(last.position)
    );
    println!("mode       {}", settings.mode.unwrap_or_default());
    println!("size       {}x{}", resolved.width, resolved.height);
    warn(&input.warnings);
    let warnings = input.warnings.len();
    println!("warnings   {warnings}");
    Ok(Status::Done)
}

/// A point to four digits after the point, without needless zeros.
fn rounded(point: DVec3) -> String {
    let [x, y, z] = point.to_array().map(|c| (c * 1e4).round() / 1e4 + 0.0);
    format!("({x}, {y}, {z})")
}
