use super::args::BakeArguments;
use super::light::{LightStore, PathLight};
use super::loading::load;
use super::{Failure, Status};
use crate::input::{GlobalIllumination, Mode, Settings};

pub(super) fn run(arguments: &BakeArguments) -> Result<Status, Failure> {
    let flags = arguments.settings.settings();
    flags.check().map_err(|error| error.of_flag())?;
    let loaded = load(&arguments.input, &arguments.threads)?;
    let given = loaded.settings(flags);
    let given = Settings {
        mode: given.mode.or(Some(Mode::Montecarlo)),
        gi: Some(GlobalIllumination::Cached),
        ..given
    };
    given.check_together()?;
    let settings = given.resolve(loaded.path.path.timeline().frame_count());
    let store = LightStore::Shared(arguments.out.clone());
    let light = PathLight::open(store, &loaded, &settings, arguments.force)?;
    light.bake(&loaded, &settings, arguments.quiet)?;
    Ok(Status::Done)
}
