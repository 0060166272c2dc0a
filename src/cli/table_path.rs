//! Where the program keeps its tables.

use std::env;
use std::path::{Path, PathBuf};

use etcetera::BaseStrategy;

/// The folder of the tables that belong to the current folder.
const FOLDER: &str = "tables";

/// The environment variable that names the folder of the tables where the current folder has none.
const VARIABLE: &str = "DARKNESS_CACHE";

/// Returns the file of the table called `name`: in the folder `tables` if there is one, else in the user's cache, by
/// the system's convention.
pub(super) fn default_path(name: &str) -> PathBuf {
    let folder = if Path::new(FOLDER).is_dir() {
        FOLDER.into()
    } else {
        cache().unwrap_or_else(|| FOLDER.into())
    };
    folder.join(format!("{name}.table"))
}

/// Returns the file of the table called `name` below the current folder, for jobs that run elsewhere.
pub(super) fn portable_path(name: &str) -> PathBuf {
    Path::new(FOLDER).join(format!("{name}.table"))
}

/// Returns the folder that the environment names, or the program's in the user's cache. A user without a home has none.
fn cache() -> Option<PathBuf> {
    let named = env::var_os(VARIABLE).filter(|name| !name.is_empty());
    let of_user = || {
        let folders = etcetera::base_strategy::choose_native_strategy().ok()?;
        Some(folders.cache_dir().join("darkness"))
    };
    named.map(PathBuf::from).or_else(of_user)
}
