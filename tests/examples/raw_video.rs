//! Renders a sequence as raw video to the standard output, without files in between: a frame sink that writes frames
//! in order.
//!
//! ```sh
//! cargo run --release --example raw_video -- scenes/test3.ron paths/test3.ron \
//!     | ffmpeg -f rawvideo -pix_fmt rgb24 -video_size 640x480 -framerate 24 -i - -pix_fmt yuv420p video.mp4
//! ```

use flythrough::camera_formats::load_camera_path;
use flythrough::input::{GlobalIllumination, InputFiles, Settings, load_scene};
use flythrough::render::{
    Claim, EncodedFrame, FrameSink, RenderObserver, RenderedFrame, Renderer, SinkError,
};
use std::collections::BTreeMap;
use std::error::Error;
use std::io::{self, Write};
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// Writes frames in order. They come from two threads, so that one may overtake another: it waits here.
struct RawVideo {
    exposure: f32,
    waiting: Mutex<Waiting>,
    has_failed: AtomicBool,
}

#[derive(Default)]
struct Waiting {
    next: u32,
    frames: BTreeMap<u32, Vec<u8>>,
}

impl Waiting {
    /// The next frame of the video, if it is there.
    fn next(&mut self) -> Option<Vec<u8>> {
        let frame = self.frames.remove(&self.next)?;
        self.next += 1;
        Some(frame)
    }
}

impl FrameSink for RawVideo {
    type Lock = ();

    fn claim(&self, _: u32, _: bool) -> Result<Claim<()>, SinkError> {
        // No other process writes to this pipe.
        Ok(Claim::Granted(()))
    }

    fn encode(&self, frame: u32, mut rendered: RenderedFrame) -> Result<EncodedFrame, SinkError> {
        rendered.film.expose(self.exposure);
        Ok(EncodedFrame {
            image: rendered.film.to_srgb8_dithered(frame),
            maps: Vec::new(),
        })
    }

    fn store(&self, frame: u32, (): (), encoded: &EncodedFrame) -> Result<(), SinkError> {
        let mut waiting = self.waiting.lock().map_err(|error| error.to_string())?;
        waiting.frames.insert(frame, encoded.image.clone());
        while let Some(image) = waiting.next() {
            io::stdout().write_all(&image)?;
        }
        Ok(())
    }
}

impl RenderObserver for RawVideo {
    fn is_stopped(&self) -> bool {
        self.has_failed.load(Ordering::Relaxed)
    }

    fn frame_failed(&self, _: u32, _: &SinkError) {
        // A video has no gaps: frames after a lost one are of no use.
        self.has_failed.store(true, Ordering::Relaxed);
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, path] = &arguments[..] else {
        return Err("usage: raw_video SCENE PATH | ffmpeg -f rawvideo -pix_fmt rgb24 ...".into());
    };
    let mut files = InputFiles::default();
    let scene = load_scene(Path::new(scene), &mut files)?;
    let path = load_camera_path(Path::new(path), &mut files)?;
    let settings = Settings {
        gi: Some(GlobalIllumination::PathTraced),
        ..path.settings.or(scene.settings)
    };
    settings.check_together()?;

    let frames: Vec<u32> = (0..path.path.timeline().frame_count()).collect();
    let renderer = Renderer::new(&scene.scene, settings.resolve(frames.len() as u32), None)?;
    let video = RawVideo {
        exposure: settings.exposure.unwrap_or(0.0),
        waiting: Mutex::default(),
        has_failed: AtomicBool::new(false),
    };
    let pool = rayon::ThreadPoolBuilder::new().build()?;
    let outcome = renderer.render_sequence(&path.path, &frames, &pool, &video, &video);
    match outcome.failures.into_iter().next() {
        Some((frame, error)) => Err(format!("frame {frame}: {error}").into()),
        None => Ok(io::stdout().flush()?),
    }
}
