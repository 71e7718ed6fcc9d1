//! OBJ models and their MTL material libraries, parsed by tobj.

use super::error::InputError;
use super::files::{InputFiles, relative_to};
use super::obj_lines::Lines;
use glam::{DVec2, DVec3, Vec2, Vec3};
use std::cell::RefCell;
use std::path::{Path, PathBuf};

/// A model as its file describes it, in its own coordinates.
#[derive(Debug)]
pub(super) struct ObjModel {
    pub(super) parts: Vec<ObjPart>,
    pub(super) materials: Vec<ObjMaterial>,
    /// What the file asks for and does not get.
    pub(super) warnings: Vec<String>,
}

/// The triangles of one object and one material.
#[derive(Debug)]
pub(super) struct ObjPart {
    pub(super) positions: Vec<DVec3>,
    /// Empty, or one for each position, of any length.
    pub(super) normals: Vec<DVec3>,
    /// Empty, or one for each position.
    pub(super) uvs: Vec<Vec2>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// An index of the model's materials.
    pub(super) material: Option<usize>,
}

/// A material of an MTL file.
#[derive(Debug)]
pub(super) struct ObjMaterial {
    pub(super) diffuse: Vec3,
    pub(super) texture: Option<ObjTexture>,
    pub(super) specular: Vec3,
    pub(super) shininess: f32,
    pub(super) reflective: Vec3,
}

/// A texture of an MTL file and where it is named.
#[derive(Debug)]
pub(super) struct ObjTexture {
    pub(super) file: PathBuf,
    pub(super) library: PathBuf,
    pub(super) key: String,
}

/// Reads an OBJ file. Its material library is only read if `with_materials`.
pub(super) fn load(
    file: &Path,
    bytes: &[u8],
    with_materials: bool,
    files: &mut InputFiles,
) -> Result<ObjModel, InputError> {
    let options = tobj::LoadOptions {
        triangulate: true,
        single_index: true,
        ignore_points: true,
        ignore_lines: true,
    };
    let text = String::from_utf8_lossy(bytes);
    let mut reader = Lines::new(text.as_bytes());
    // tobj goes on without a library that cannot be loaded; this keeps the reason.
    let state = RefCell::new((files, None, Vec::new()));
    let loaded = tobj::load_obj_buf(&mut reader, &options, |name| {
        let (files, failure, warnings) = &mut *state.borrow_mut();
        if !with_materials {
            return Ok(Default::default());
        }
        let library = relative_to(file, &name.to_string_lossy());
        load_library(file, &library, files, warnings).map_err(|error| {
            failure.get_or_insert(error);
            tobj::LoadError::GenericFailure
        })
    });
    let (_, failure, libraries) = state.into_inner();
    if let Some(failure) = failure {
        return Err(failure);
    }
    let (models, materials) = loaded.map_err(|error| InputError::Model {
        file: file.to_owned(),
        line: reader.line(),
        message: error.to_string(),
    })?;
    let mut warnings = Vec::new();
    let mut parts = Vec::new();
    for model in models {
        parts.push(part(file, &model.name, model.mesh, &mut warnings)?);
    }
    let materials: Vec<_> = materials.unwrap_or_default();
    let mut resolved = Vec::new();
    for material in &materials {
        // The library that has the material last defines it, as in the file.
        let library = libraries
            .iter()
            .rev()
            .find(|(_, names)| names.contains(&material.name))
            .map_or(file, |(library, _)| library);
        resolved.push(resolve(library, material, &mut warnings)?);
    }
    if with_materials {
        let bare: usize = parts
            .iter()
            .filter(|p| p.material.is_none())
            .map(|p| p.triangles.len())
            .sum();
        if bare > 0 {
            warnings.push(format!(
                "{}: {bare} triangles name no material of its libraries and are made grey; give \
                 the object a `material`",
                file.display()
            ));
        }
    }
    Ok(ObjModel {
        parts,
        materials: resolved,
        warnings,
    })
}

type Libraries = Vec<(PathBuf, Vec<String>)>;
type Library = (
    Vec<tobj::Material>,
    std::collections::HashMap<String, usize>,
);

fn load_library(
    file: &Path,
    library: &Path,
    files: &mut InputFiles,
    libraries: &mut Libraries,
) -> Result<Library, InputError> {
    let bytes = files.read_reference(library, file, "mtllib")?;
    let text = String::from_utf8_lossy(&bytes);
    let mut reader = Lines::new(text.as_bytes());
    let loaded = tobj::load_mtl_buf(&mut reader).map_err(|error| InputError::Model {
        file: library.to_owned(),
        line: reader.line(),
        message: error.to_string(),
    })?;
    let names = loaded.0.iter().map(|m| m.name.clone()).collect();
    libraries.push((library.to_owned(), names));
    Ok(loaded)
}

fn part(
    file: &Path,
    name: &str,
    mesh: tobj::Mesh,
    warnings: &mut Vec<String>,
) -> Result<ObjPart, InputError> {
    let positions: Vec<DVec3> = triples(&mesh.positions);
    let mut normals: Vec<DVec3> = triples(&mesh.normals);
    let mut uvs: Vec<Vec2> = mesh
        .texcoords
        .as_chunks()
        .0
        .iter()
        .map(|uv| DVec2::from_array(*uv).as_vec2())
        .collect();
    for (what, count, clear) in [
        (
            "normals",
            normals.len(),
            &mut (|| normals.clear()) as &mut dyn FnMut(),
        ),
        ("texture coordinates", uvs.len(), &mut || uvs.clear()),
    ] {
        if count != 0 && count != positions.len() {
            warnings.push(format!(
                "{}: object \"{name}\" gives {what} to some corners only; they are not used",
                file.display()
            ));
            clear();
        }
    }
    let finite = positions.iter().all(|p| p.is_finite())
        && normals.iter().all(|n| n.is_finite())
        && uvs.iter().all(|uv| uv.is_finite());
    if !finite {
        return Err(InputError::Value {
            file: file.to_owned(),
            key: format!("object \"{name}\""),
            message: "has a corner whose numbers are not finite".to_owned(),
        });
    }
    Ok(ObjPart {
        triangles: mesh.indices.as_chunks().0.to_vec(),
        positions,
        normals,
        uvs,
        material: mesh.material_id,
    })
}

fn triples(numbers: &[f64]) -> Vec<DVec3> {
    let (triples, _) = numbers.as_chunks();
    triples.iter().copied().map(DVec3::from_array).collect()
}

/// Kd times map_Kd is diffuse. Ks and Ns are the highlight, unless `illum` says that there is none
/// (0, 1). `illum` 3 and 5 ask for reflection: a mirror of the share Ks.
fn resolve(
    library: &Path,
    material: &tobj::Material,
    warnings: &mut Vec<String>,
) -> Result<ObjMaterial, InputError> {
    let key = |name: &str| format!("material \"{}\": {name}", material.name);
    let color = |name: &str, value: Option<[f64; 3]>, default: f64| {
        let color = DVec3::from_array(value.unwrap_or([default; 3]));
        if color.is_finite() {
            return Ok(color.clamp(DVec3::ZERO, DVec3::ONE).as_vec3());
        }
        Err(InputError::Value {
            file: library.to_owned(),
            key: key(name),
            message: "is not a colour of finite numbers".to_owned(),
        })
    };
    let ignored = [
        ("Ke", material.emissive.is_some_and(|ke| ke != [0.0; 3])),
        ("d", material.dissolve.is_some_and(|d| d < 1.0)),
        ("map_d", material.dissolve_texture.is_some()),
        ("map_Ks", material.specular_texture.is_some()),
        ("map_Bump", material.normal_texture.is_some()),
    ];
    let ignored: Vec<&str> = ignored
        .iter()
        .filter(|(_, is)| *is)
        .map(|(name, _)| *name)
        .collect();
    if !ignored.is_empty() {
        let names = ignored.join(", ");
        warnings.push(format!("{}: {} not used", library.display(), key(&names)));
    }
    let diffuse = color("Kd", material.diffuse, 1.0)?;
    if material.diffuse_texture.is_some() && diffuse == Vec3::ZERO {
        let black = key("Kd 0 0 0 makes its map_Kd black");
        warnings.push(format!("{}: {black}", library.display()));
    }
    let specular = color("Ks", material.specular, 0.0)?;
    let illumination = material.illumination_model;
    let shininess = material.shininess.unwrap_or(0.0);
    Ok(ObjMaterial {
        diffuse,
        texture: material.diffuse_texture.as_ref().map(|name| ObjTexture {
            file: relative_to(library, name),
            library: library.to_owned(),
            key: key("map_Kd"),
        }),
        specular: match illumination {
            Some(0 | 1) => Vec3::ZERO,
            _ => specular,
        },
        shininess: if shininess.is_finite() {
            shininess.max(0.0) as f32
        } else {
            0.0
        },
        reflective: match illumination {
            Some(3 | 5) => specular,
            _ => Vec3::ZERO,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load_text(text: &str) -> Result<ObjModel, InputError> {
        load(
            Path::new("x.obj"),
            text.as_bytes(),
            true,
            &mut InputFiles::default(),
        )
    }

    #[test]
    fn polygons_negative_indices_and_normals() {
        let model = load_text(
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0.5 0\nvn 0 0 2\n\
             f -5//1 -4//1 -3//1 -2//1 -1//1\n",
        )
        .expect("a pentagon");
        let part = &model.parts[0];
        assert_eq!(part.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        assert_eq!(part.positions[4], DVec3::new(-1.0, 0.5, 0.0));
        assert_eq!(part.normals, [DVec3::Z * 2.0; 5]);
        assert!(part.uvs.is_empty());
        assert_eq!(model.warnings.len(), 1);
        assert!(model.warnings[0].contains("3 triangles name no material"));
    }

    #[test]
    fn the_line_of_a_fault() {
        let error = load_text("v 0 0 0\nv 1 0 0\n\nv 1 x 0\nf 1 2 3\n").map(|_| ());
        assert_eq!(
            error.map_err(|e| e.to_string()),
            Err("x.obj:4: position parse error".into())
        );
        let error = load_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 9\n").map(|_| ());
        let message = error.map_err(|e| e.to_string());
        assert_eq!(
            message,
            Err("x.obj:4: face vertex index out of bounds".into())
        );
    }

    #[test]
    fn corners_without_texture_coordinates_among_others_are_said() {
        let model = load_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nf 1/1 2 3\n").expect("a face");
        assert!(model.parts[0].uvs.is_empty());
        assert!(model.warnings[0].contains("texture coordinates to some corners only"));
    }

    #[test]
    fn faces_with_and_without_normals_in_one_object() {
        let model = load_text(
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1 2 3\nf 3 2 1\n\
             f 1//1 2//1 3//1\nf 1 2 3 9\n",
        );
        assert!(model.is_err_and(|e| e.to_string().starts_with("x.obj:9: ")));
        let model =
            load_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1 2 3\nf 3 2 1\n")
                .expect("two groups");
        let counts = model
            .parts
            .iter()
            .map(|p| (p.triangles.len(), p.normals.len()));
        assert_eq!(counts.collect::<Vec<_>>(), [(1, 3), (2, 0)]);
    }

    #[test]
    fn material_library() {
        let library = tempfile::tempdir().expect("a folder");
        let mtl = "newmtl a\nKd 0.5 0.25 0\nKs 1 1 1\nNs 20\nillum 2\nmap_Kd sub\\t.png\n\
                   newmtl b\nKs 0.5 0.5 0.5\nillum 3\nKe 1 0 0\n";
        std::fs::write(library.path().join("m.mtl"), mtl).expect("writable");
        let obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl b\nf 1 2 3\nusemtl a\nf 3 2 1\n";
        let file = library.path().join("x.obj");
        let model = load(&file, obj.as_bytes(), true, &mut InputFiles::default()).expect("loads");
        let used: Vec<_> = model.parts.iter().map(|p| p.material).collect();
        assert_eq!(used, [Some(1), Some(0)]);
        let [a, b] = &model.materials[..] else {
            panic!("two materials")
        };
        assert_eq!((a.diffuse, a.shininess), (Vec3::new(0.5, 0.25, 0.0), 20.0));
        assert_eq!((a.specular, a.reflective), (Vec3::ONE, Vec3::ZERO));
        let texture = a.texture.as_ref().map(|t| t.file.clone());
        assert_eq!(texture, Some(library.path().join("sub/t.png")));
        assert_eq!((b.diffuse, b.reflective), (Vec3::ONE, Vec3::splat(0.5)));
        assert!(model.warnings.len() == 1 && model.warnings[0].ends_with("Ke not used"));
        let missing = load(&file, b"mtllib n.mtl\n", true, &mut InputFiles::default());
        assert!(missing.is_err_and(|e| e.to_string().contains("n.mtl")));
        assert!(load(&file, b"mtllib n.mtl\n", false, &mut InputFiles::default()).is_ok());
    }
}
