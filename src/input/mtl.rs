//! MTL material libraries, parsed by tobj.

use super::check::MAX_RADIANCE;
use super::error::InputError;
use super::files::{InputFiles, relative_to};
use super::statements::{Statements, numbers, text, words, write_statement};
use super::unused::Unused;
use glam::{DVec3, Vec3};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// A material of an MTL file.
#[derive(Debug)]
pub(super) struct ObjMaterial {
    /// Its name and that of its library, for messages.
    pub(super) name: String,
    pub(super) diffuse: Vec3,
    pub(super) texture: Option<ObjTexture>,
    pub(super) specular: Vec3,
    pub(super) shininess: f32,
    pub(super) reflective: Vec3,
    /// The emitted radiance, without its texture.
    pub(super) emission: Vec3,
    pub(super) emission_texture: Option<ObjTexture>,
}

/// A texture of an MTL file, and the file and key that name it.
#[derive(Debug)]
pub(super) struct ObjTexture {
    pub(super) file: PathBuf,
    pub(super) library: PathBuf,
    pub(super) key: String,
}

/// The largest exponent of a Phong highlight.
pub(super) const MAX_SHININESS: f64 = 1e6;

/// The material libraries of one model.
#[derive(Default)]
pub(super) struct Libraries {
    /// The materials of all libraries, in the order of tobj's indices.
    pub(super) materials: Vec<ObjMaterial>,
    /// About statements that are not supported.
    pub(super) warnings: Vec<String>,
}

/// Materials, and their indices by name.
type Library = (Vec<tobj::Material>, HashMap<String, usize>);

impl Libraries {
    /// Reads a library that the model `from` names.
    pub(super) fn load(
        &mut self,
        library: &Path,
        from: &Path,
        files: &mut InputFiles,
    ) -> Result<Library, InputError> {
        let bytes = files.read_reference(library, from, "mtllib")?;
        let text = text(library, &bytes)?;
        let mut is_named = false;
        let mut unused = Unused::default();
        let mut statements = Statements::new(&text, |keyword, rest, out| {
            is_named |= keyword == "newmtl";
            if !is_named {
                return Err(format!("`{keyword}` stands before the first `newmtl`"));
            }
            prepare(keyword, rest, out, &mut unused)
        });
        let loaded = match tobj::load_mtl_buf(&mut statements) {
            Ok(loaded) => loaded,
            Err(error) => return Err(statements.fault(library, error)),
        };
        for (number, material) in loaded.0.iter().enumerate() {
            if loaded.1[&material.name] != number {
                unused.add("material whose name is defined again below");
            }
            let resolved = resolve(library, material, &mut unused);
            if resolved.texture.is_some() && resolved.diffuse == Vec3::ZERO {
                self.warnings.push(format!(
                    "{}: material \"{}\": Kd 0 0 0 makes its map_Kd black",
                    library.display(),
                    material.name
                ));
            }
            self.materials.push(resolved);
        }
        self.warnings.extend(unused.warning(library));
        Ok(loaded)
    }
}

/// Checks a statement that is used and writes it for tobj, which takes colours of three numbers only; counts statements
/// that are not supported, unless they leave the picture as it is.
fn prepare(keyword: &str, rest: &str, out: &mut String, unused: &mut Unused) -> Result<(), String> {
    let words = words(rest);
    match keyword {
        "newmtl" if rest.is_empty() => return Err("`newmtl` has no name after it".to_owned()),
        "newmtl" => write_statement(out, keyword, &[rest]),
        "Kd" | "Ks" | "Ke" => match numbers(keyword, &words)?[..] {
            [_] => write_statement(out, keyword, &[words[0]; 3]),
            [_, _, _] => write_statement(out, keyword, &words),
            _ => {
                let given = words.len();
                return Err(format!(
                    "`{keyword}` has {given} numbers; it takes one or three"
                ));
            }
        },
        "Ns" => match numbers(keyword, &words)?[..] {
            [_] => write_statement(out, keyword, &[words[0]]),
            _ => return Err("`Ns` takes one number".to_owned()),
        },
        "illum" => match words[..] {
            [model @ ("0" | "1" | "2" | "3" | "4" | "5")] => {
                write_statement(out, keyword, &[model]);
            }
            ["6" | "7" | "8" | "9" | "10"] => unused.add("`illum` above 5"),
            _ => return Err("`illum` takes a whole number from 0 to 10".to_owned()),
        },
        "map_Kd" | "map_Ke" if rest.is_empty() => {
            return Err(format!("`{keyword}` names no file"));
        }
        "map_Kd" | "map_Ke" if rest.starts_with('-') => {
            return Err(format!(
                "`{keyword}`: options are not supported; write the file's name alone"
            ));
        }
        "map_Kd" | "map_Ke" => write_statement(out, keyword, &[rest]),
        // The ambient term uses the diffuse colour, and nothing is refractive.
        "Ka" | "map_Ka" | "Ni" => {}
        "d" if matches!(words[..], [d] if d.parse().is_ok_and(|d: f64| d >= 1.0)) => {}
        _ => unused.add(&format!("`{keyword}`")),
    }
    Ok(())
}

/// The diffuse reflectance is Kd times map_Kd. Ks and Ns are the highlight, unless `illum` is 0 or 1. With `illum` 3 or
/// 5, Ks is the mirror reflectance as well. The
/// emitted radiance is Ke times map_Ke, map_Ke alone where Ke is black or missing.
fn resolve(library: &Path, material: &tobj::Material, unused: &mut Unused) -> ObjMaterial {
    let illumination = material.illumination_model;
    let mut color = |name: &str, value: Option<[f64; 3]>, default: f64| {
        let color = DVec3::from_array(value.unwrap_or([default; 3]));
        let clamped = color.clamp(DVec3::ZERO, DVec3::ONE);
        if clamped != color {
            unused.add(&format!("`{name}` outside 0 to 1 (clamped)"));
        }
        clamped.as_vec3()
    };
    let diffuse = color("Kd", material.diffuse, 1.0);
    let specular = color("Ks", material.specular, 0.0);
    let given = material.shininess.unwrap_or(0.0);
    let shininess = given.clamp(0.0, MAX_SHININESS);
    if shininess != given {
        unused.add(&format!("`Ns` outside 0 to {MAX_SHININESS} (clamped)"));
    }
    let texture = |keyword: &str, name: &String| ObjTexture {
        file: relative_to(library, name),
        library: library.to_owned(),
        key: format!("material \"{}\": {keyword}", material.name),
    };
    let emission_texture = material.unknown_param.get("map_Ke");
    let given = DVec3::from_array(material.emissive.unwrap_or([0.0; 3]));
    let mut emission = given.clamp(DVec3::ZERO, DVec3::splat(MAX_RADIANCE));
    if emission != given {
        unused.add(&format!("`Ke` outside 0 to {MAX_RADIANCE:e} (clamped)"));
    }
    // Exporters write the map, and the colour that it takes the place of.
    if emission_texture.is_some() && emission == DVec3::ZERO {
        emission = DVec3::ONE;
    }
    let file = library.file_name().unwrap_or_default().to_string_lossy();
    ObjMaterial {
        name: format!("\"{}\" of {file}", material.name),
        diffuse,
        texture: material
            .diffuse_texture
            .as_ref()
            .map(|name| texture("map_Kd", name)),
        specular: match illumination {
            Some(0 | 1) => Vec3::ZERO,
            _ => specular,
        },
        shininess: shininess as f32,
        reflective: match illumination {
            Some(3 | 5) => specular,
            _ => Vec3::ZERO,
        },
        emission: emission.as_vec3(),
        emission_texture: emission_texture.map(|name| texture("map_Ke", name)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The materials of a library's text, and warnings.
    fn load_text(text: &str) -> Result<Libraries, InputError> {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("m.mtl");
        std::fs::write(&file, text).expect("writable");
        let mut libraries = Libraries::default();
        let files = &mut InputFiles::default();
        libraries.load(&file, Path::new("x.obj"), files)?;
        Ok(libraries)
    }

    #[test]
    fn faults() {
        for (text, expected) in [
            ("Kd 1 1 1\n", ":1: `Kd` stands before the first `newmtl`"),
            ("newmtl\n", ":1: `newmtl` has no name after it"),
            (
                "newmtl a\nKd 1 1\n",
                ":2: `Kd` has 2 numbers; it takes one or three",
            ),
            ("newmtl a\nKd\n", ":2: `Kd` has 0 numbers"),
            (
                "newmtl a\nKd spectral a.rfl\n",
                ":2: `Kd`: spectral is not a number",
            ),
            (
                "newmtl a\n\nKd xyz 1 1 1\n",
                ":3: `Kd`: xyz is not a number",
            ),
            ("newmtl a\nKs 0 nan 0\n", ":2: `Ks`: nan is not a number"),
            ("newmtl a\nNs inf\n", ":2: `Ns`: inf is not a number"),
            ("newmtl a\nNs\n", ":2: `Ns` takes one number"),
            (
                "newmtl a\nillum -1\n",
                ":2: `illum` takes a whole number from 0",
            ),
            ("newmtl a\nmap_Kd\n", ":2: `map_Kd` names no file"),
            (
                "newmtl a\nmap_Kd -s 1 1 1 t.png\n",
                ":2: `map_Kd`: options are not supported",
            ),
            ("newmtl a\nKd 1 1 \\\n1\nKd 1\0", ":4: contains a zero byte"),
        ] {
            let error = load_text(text).map(|_| ()).expect_err(text).to_string();
            assert!(error.contains(&format!("m.mtl{expected}")), "{error}");
        }
    }

    #[test]
    fn a_map_of_emission_needs_no_color() {
        let text = "newmtl a\nKe 2 3 4\nmap_Ke a.png\nnewmtl b\nKe 0 0 0\nmap_Ke b.png\nnewmtl c\nmap_Ke c.png\n";
        let libraries = load_text(text).expect("three materials");
        let emissions = libraries.materials.iter().map(|m| m.emission);
        let expected = [Vec3::new(2.0, 3.0, 4.0), Vec3::ONE, Vec3::ONE];
        assert!(emissions.eq(expected));
        let maps = libraries.materials.iter().map(|m| {
            let map = m.emission_texture.as_ref()?;
            Some(map.file.file_name()?.to_owned())
        });
        assert!(maps.eq(["a.png", "b.png", "c.png"].map(|name| Some(name.into()))));
        assert_eq!(libraries.warnings, Vec::<String>::new());
    }

    #[test]
    fn what_is_not_used_is_counted() {
        let text = "\u{feff}newmtl a\n newmtl b\r\n\tKd 0.5\nKs 2 -1 1\nNs -3\nKe 1\nKe -2\nTr 1\n\
                    map_kd t.png\nillum 7\nKa x y z\nd -halo 0.6\n\
                    d 1\nmap_Ks\nnewmtl a\nKe 0\nKe 1 0 0\nNs 1e7\n";
        let libraries = load_text(text).expect("three materials");
        let [_, b, last] = &libraries.materials[..] else {
            panic!("three materials")
        };
        assert_eq!(
            (b.diffuse, b.specular),
            (Vec3::splat(0.5), Vec3::new(1.0, 0.0, 1.0))
        );
        assert_eq!((b.shininess, last.shininess), (0.0, 1e6));
        let [warning] = &libraries.warnings[..] else {
            panic!("{:?}", libraries.warnings)
        };
        let (_, unused) = warning.split_once("m.mtl: ").expect("the file");
        assert_eq!(
            unused,
            "not used: 1 `Ke` outside 0 to 1e15 (clamped), 1 `Ks` outside 0 to 1 (clamped), 2 `Ns` outside 0 to 1000000 \
             (clamped), 1 `Tr`, 1 `d`, 1 `illum` above 5, 1 `map_Ks`, 1 `map_kd`, 1 other kinds"
        );
    }
}
