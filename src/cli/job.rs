use super::Failure;
use super::args::RenderArguments;
use super::light::{LightStore, PathLight};
use super::loading::{Loaded, load};
use crate::input::{GlobalIllumination, Settings};
use crate::output::{FrameFormat, Plan, PlanCommand};
use crate::render::RenderSettings;

/// Everything that decides the frames of a folder: inputs loaded, settings resolved, and what each frame is to be.
pub(super) struct Job {
    pub(super) loaded: Loaded,
    /// Of frames that gather light exactly.
    pub(super) settings: RenderSettings,
    /// The light that frames look up; none if they gather it.
    pub(super) light: Option<PathLight>,
    pub(super) plan: Plan,
}

impl Job {
    pub(super) fn new(arguments: &RenderArguments) -> Result<Job, Failure> {
        let flags = arguments.settings.settings();
        flags.check().map_err(|error| error.of_flag())?;
        let loaded = load(&arguments.input, &arguments.threads)?;
        let of_files = loaded
            .path
            .settings
            .clone()
            .or(loaded.scene.settings.clone());
        let given = flags.or(of_files);
        given.check_together()?;
        let settings = given.resolve();
        let light = light(arguments, &given, &loaded, &settings)?;
        if arguments.aov.is_some() {
            refuse_maps_without_noise(&settings, light.is_some())?;
        }
        let exposure = given.exposure.unwrap_or(0.0);
        let plan = plan(arguments, exposure, &loaded, &settings, light.as_ref())?;
        Ok(Job {
            loaded,
            settings,
            light,
            plan,
        })
    }
}

/// The light that frames look up; none if they gather it.
fn light(
    arguments: &RenderArguments,
    given: &Settings,
    loaded: &Loaded,
    exact: &RenderSettings,
) -> Result<Option<PathLight>, Failure> {
    let frames = loaded.path.path.timeline().frame_count();
    match given.global_illumination(frames) {
        GlobalIllumination::Path => {
            let store = match &arguments.gi_cache {
                Some(file) => LightStore::Shared(file.clone()),
                None => LightStore::Own(arguments.out.join("light.cache")),
            };
            let light = PathLight::open(store, loaded, exact, arguments.force)?;
            Ok(Some(light))
        }
        GlobalIllumination::Exact if arguments.gi_cache.is_some() => {
            Err("--gi-cache: add --gi path".into())
        }
        GlobalIllumination::Exact => Ok(None),
    }
}

fn refuse_maps_without_noise(settings: &RenderSettings, looks_up: bool) -> Result<(), Failure> {
    let (has_noise, advice) = match looks_up {
        true => (
            settings.has_noise_looking_up(),
            "take more camera samples, or --gi exact",
        ),
        false => (settings.has_noise(), "choose a montecarlo mode"),
    };
    match has_noise {
        true => Ok(()),
        false => Err(format!("--aov error: nothing is left to chance here; {advice}").into()),
    }
}

fn plan(
    arguments: &RenderArguments,
    exposure: f32,
    loaded: &Loaded,
    settings: &RenderSettings,
    light: Option<&PathLight>,
) -> Result<Plan, Failure> {
    let path = &loaded.path.path;
    let timeline = path.timeline();
    let format = FrameFormat::from(arguments.format);
    let program = Plan::program();
    // Of the path a frame knows its camera, and the light that is worked out for all of it.
    let light_of = light.map(PathLight::paths);
    let of_all = format!("{program} {settings:?} {light_of:?} {exposure} {format:?}");
    let made_from = |frame| {
        let mut hasher = blake3::Hasher::new();
        hasher.update(loaded.scene_fingerprint.as_bytes());
        hasher.update(of_all.as_bytes());
        hasher.update(format!("{frame} {:?}", path.camera(frame)).as_bytes());
        hasher.finalize().to_string()
    };
    let typed = std::env::args_os().map(|argument| argument.to_string_lossy().into_owned());
    Ok(Plan {
        program,
        command: PlanCommand {
            folder: std::env::current_dir()?,
            arguments: typed.collect(),
        },
        fps: timeline.fps,
        frames: timeline.frame_count(),
        width: settings.width,
        height: settings.height,
        format,
        exposure,
        error_maps: arguments.aov.is_some(),
        path_light: light.is_some(),
        made_from: (0..timeline.frame_count()).map(made_from).collect(),
    })
}
