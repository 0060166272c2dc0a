//! Scenes and animations from text, files and the built-in ones.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;

use super::animation::Animation;
use super::builtin::Builtin;
use super::checked::Scene;
use super::error::SceneError;
use super::file::SceneFile;
use super::overrides::{self, Override};

/// The longest file that is read as a scene, in bytes.
const LONGEST_FILE: u64 = 1 << 20;

impl Scene {
    /// Reads a scene from its TOML form, which the [module's page](super) describes.
    ///
    /// # Errors
    /// [`SceneError::Toml`] with line and column where the text is not TOML, or a key is missing, unknown or of the
    /// wrong type; [`SceneError::Value`] for a value that is not allowed.
    pub fn from_toml(text: &str) -> Result<Self, SceneError> {
        Animation::from_toml(text)?.first_frame()
    }

    /// The built-in scene of this name; [`builtins`](super::builtins) lists them.
    ///
    /// # Errors
    /// [`SceneError::Unknown`], which names them.
    pub fn builtin(name: &str) -> Result<Self, SceneError> {
        let builtin =
            Builtin::named(name).ok_or_else(|| SceneError::Unknown { path: name.into() })?;
        Self::from_toml(builtin.toml())
    }

    /// The built-in scene of this name, or else the scene in the TOML file at this path.
    ///
    /// A file that has the name of a built-in scene is reached as `./classic`. The files that a sky names are relative
    /// to the folder of the scene's file.
    ///
    /// # Errors
    /// [`SceneError::Unknown`] where there is neither, [`SceneError::Read`] for a file that cannot be read,
    /// [`SceneError::InFile`] for a file that holds no valid scene.
    pub fn load(path_or_name: impl AsRef<Path>) -> Result<Self, SceneError> {
        load(path_or_name.as_ref(), &[], |file| {
            Animation::new(file)?.first_frame()
        })
    }

    /// The scene's TOML form with every key written out. [`Scene::from_toml`] reads the same scene back.
    pub fn to_toml(&self) -> String {
        SceneFile::from(self).to_string()
    }
}

impl Animation {
    /// Reads an animation from its TOML form: a scene's, which the [module's page](super) describes, with the table
    /// [`[animation]`](super::animation).
    ///
    /// # Errors
    /// Those of [`Scene::from_toml`], for what is wrong with every frame. [`Self::frame`] returns what is wrong with
    /// one frame.
    pub fn from_toml(text: &str) -> Result<Self, SceneError> {
        Self::new(SceneFile::parse(text)?)
    }

    /// The built-in scene of this name, or else the scene in the TOML file at this path.
    ///
    /// # Errors
    /// Those of [`Scene::load`].
    pub fn load(path_or_name: impl AsRef<Path>) -> Result<Self, SceneError> {
        Self::load_with(path_or_name, &[])
    }

    /// The same, with values that take the place of some of the scene's own.
    ///
    /// # Errors
    /// Those of [`Scene::load`], and [`SceneError::Override`] for a value that is not allowed.
    pub fn load_with(
        path_or_name: impl AsRef<Path>,
        overrides: &[Override],
    ) -> Result<Self, SceneError> {
        load(path_or_name.as_ref(), overrides, Self::new)
    }
}

/// Makes something of the built-in scene of this name, or else of the file at this path. Names of files in it, and in
/// the overrides, are relative to its folder.
fn load<T>(
    path: &Path,
    overrides: &[Override],
    make: impl Fn(SceneFile) -> Result<T, SceneError>,
) -> Result<T, SceneError> {
    if let Some(builtin) = path.to_str().and_then(Builtin::named) {
        let made = overrides::parse(builtin.toml(), overrides).and_then(make);
        return made.map_err(|error| overrides::blame(error, overrides));
    }
    let text = read(path).map_err(|error| {
        let path = path.to_owned();
        if error.kind() == io::ErrorKind::NotFound {
            SceneError::Unknown { path }
        } else {
            SceneError::Read { path, error }
        }
    })?;
    let made = overrides::parse(&text, overrides).and_then(|mut file| {
        if let (Some(sky), Some(folder)) = (&mut file.sky, path.parent()) {
            Arc::make_mut(sky).resolve(folder);
        }
        make(file)
    });
    made.map_err(|error| match overrides::blame(error, overrides) {
        error @ SceneError::Override { .. } => error,
        error => SceneError::InFile {
            path: path.to_owned(),
            error: Box::new(error),
        },
    })
}

/// Reads a file of at most [`LONGEST_FILE`] bytes: a device may have no end.
fn read(path: &Path) -> io::Result<String> {
    let wrong = |problem| io::Error::new(io::ErrorKind::InvalidData, problem);
    if fs::metadata(path)?.is_dir() {
        return Err(wrong("it is a folder, and a scene is a TOML file"));
    }
    let mut bytes = Vec::new();
    let length = File::open(path)?
        .take(LONGEST_FILE + 1)
        .read_to_end(&mut bytes)?;
    // A long picture is no text in its first part already, which says more than its length.
    if length as u64 > LONGEST_FILE && str::from_utf8(&bytes).is_ok() {
        return Err(wrong("it is over 1 MiB long, which no scene is"));
    }
    String::from_utf8(bytes).map_err(|_| wrong("it is not a text in UTF-8, as a scene's TOML is"))
}

#[cfg(test)]
mod tests {
    use super::super::{DEFAULT_SCENE, StarSource, builtins};
    use super::*;

    #[test]
    fn load_takes_a_builtin_name() {
        let builtin = Scene::builtin("face-on").unwrap();
        assert_eq!(Scene::load("face-on").unwrap(), builtin);
        assert!(Scene::builtin(DEFAULT_SCENE).is_ok());
        assert!(Scene::builtin("no-such-scene").is_err());
    }

    #[test]
    fn load_reads_a_file_and_errors_name_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        let scene = Scene::builtin("inside").unwrap();
        std::fs::write(&path, scene.to_toml()).unwrap();
        assert_eq!(Scene::load(&path).unwrap(), scene);

        std::fs::write(
            &path,
            scene.to_toml().replace("outer = 12.0", "outer = 2.0"),
        )
        .unwrap();
        let message = Scene::load(&path).unwrap_err().to_string();
        assert!(
            message.contains("mine.toml") && message.contains("disk.outer"),
            "{message}"
        );

        let message = Scene::load(folder.path()).unwrap_err().to_string();
        assert!(
            message.contains(&folder.path().display().to_string()),
            "{message}"
        );
    }

    #[test]
    fn files_of_a_sky_are_relative_to_the_folder_of_the_scenes_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        let absolute = folder.path().join("bright.csv");
        let sky = format!(
            "[sky]\npanorama = \"skies/night.exr\"\nstars = '{}'\n\n[image]",
            absolute.display()
        );
        let toml = Scene::builtin("inside").unwrap().to_toml();
        let toml = toml.replace("[image]", &sky);
        std::fs::write(&path, &toml).unwrap();
        let files = |scene: &Scene| {
            let sky = scene.sky().unwrap().clone();
            let StarSource::File(stars) = sky.stars.unwrap().source else {
                panic!("no catalogue");
            };
            [sky.panorama.unwrap(), stars]
        };
        let animation = Animation::load(&path).unwrap();
        for scene in [Scene::load(&path).unwrap(), animation.frame(1).unwrap()] {
            let [panorama, stars] = files(&scene);
            assert_eq!(panorama.name, "skies/night.exr");
            assert_eq!(panorama.path, folder.path().join("skies/night.exr"));
            assert_eq!(stars.path, absolute);
            assert_eq!(scene.to_toml(), animation.to_toml());
        }
        let [panorama, stars] = files(&Scene::from_toml(&toml).unwrap());
        assert_eq!(panorama.path, Path::new("skies/night.exr"));
        assert_eq!(stars.path, absolute);
    }

    #[test]
    fn load_lists_the_builtin_names_where_nothing_is_found() {
        let message = Scene::load("clasic").unwrap_err().to_string();
        assert!(message.contains("clasic"), "{message}");
        for builtin in builtins() {
            assert!(message.contains(builtin.name()), "{message}");
        }
    }
}
