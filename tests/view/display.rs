//! A virtual display, and the program's window in it.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use darkness::render::needs::Needs;
use darkness::render::{Form, Renderer};
use darkness::scene::{Navigator, View};
use darkness::{Scene, Table};
use tempfile::{TempDir, tempdir};

use crate::process::darkness;
use crate::tables::table;
use crate::tools;

/// The longest that anything is waited for. A busy machine may take long.
const PATIENCE: Duration = Duration::from_secs(120);

/// The window's size.
pub(crate) const SIZE: (u32, u32) = (320, 180);

/// The window's size, as an option.
pub(crate) const SIZE_OPTION: &str = "--size=320x180";

/// Returns whether a display can be simulated.
pub(crate) fn can_show() -> bool {
    ["Xvfb", "xdotool", "xwd"]
        .map(tools::has)
        .into_iter()
        .all(|has| has)
}

/// A display without a window manager.
pub(crate) struct Screen {
    server: Child,
    name: String,
}

impl Screen {
    pub(crate) fn new() -> Self {
        // Servers that begin at once may choose the same number.
        static STARTING: Mutex<()> = Mutex::new(());
        let _one_at_a_time = STARTING.lock().unwrap_or_else(PoisonError::into_inner);
        let mut server = Command::new("Xvfb")
            .args([
                "-noreset",
                "-displayfd",
                "1",
                "-screen",
                "0",
                "1400x800x24",
                "-nolisten",
                "tcp",
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut number = String::new();
        let mut lines = BufReader::new(server.stdout.take().unwrap());
        lines.read_line(&mut number).unwrap();
        let name = format!(":{}", number.trim());
        Self { server, name }
    }

    /// The display's name.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Runs a tool of this display, and returns its standard output.
    fn tool(&self, line: &[&str]) -> Vec<u8> {
        let mut tool = Command::new(line[0]);
        let output = tool
            .args(&line[1..])
            .env("DISPLAY", &self.name)
            .output()
            .unwrap();
        output.stdout
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        // It removes the display's lock; killed it would leave it.
        let process = self.server.id().to_string();
        let _ = Command::new("kill").arg(process).status();
        let _ = self.server.wait();
    }
}

/// The program's window, and the folder that it runs in.
pub(crate) struct Window {
    pub(crate) folder: TempDir,
    child: Option<Child>,
    id: String,
    screen: Screen,
}

/// Returns a folder with the tables that scenes need.
pub(crate) fn with_tables() -> TempDir {
    let folder = tempdir().unwrap();
    fs::create_dir(folder.path().join("tables")).unwrap();
    for name in ["draft", "standard"] {
        let file = folder.path().join("tables").join(format!("{name}.table"));
        table(name).save(file).unwrap();
    }
    folder
}

/// A window's pixels: red, green and blue, row by row from the top.
#[derive(Clone, PartialEq)]
pub(crate) struct Picture {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) bytes: Vec<u8>,
}

impl Window {
    /// Opens a window on a scene, in a folder with tables.
    pub(crate) fn open(scene: &str) -> Self {
        Self::open_in(with_tables(), &[scene, SIZE_OPTION])
    }

    /// Opens a window in a folder, with these arguments.
    pub(crate) fn open_in(folder: TempDir, args: &[&str]) -> Self {
        let screen = Screen::new();
        let child = darkness(folder.path(), &[&["view"], args].concat())
            .env("DISPLAY", &screen.name)
            .env_remove("WAYLAND_DISPLAY")
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut window = Self {
            folder,
            child: Some(child),
            id: String::new(),
            screen,
        };
        let id = wait_for("a window", || {
            let child = window.child.as_mut().unwrap();
            if child.try_wait().unwrap().is_some() {
                let output = window.child.take().unwrap().wait_with_output().unwrap();
                panic!("{}", String::from_utf8_lossy(&output.stderr));
            }
            let found = window
                .screen
                .tool(&["xdotool", "search", "--onlyvisible", "--name", "."]);
            let found = String::from_utf8(found).unwrap();
            found.lines().next().map(str::to_owned)
        });
        window.id = id;
        window
            .screen
            .tool(&["xdotool", "windowfocus", "--sync", &window.id]);
        window
    }

    /// The process.
    pub(crate) fn process(&self) -> u32 {
        self.child.as_ref().unwrap().id()
    }

    /// Does something with the mouse or the keyboard, in words of xdotool.
    pub(crate) fn hand(&self, words: &str) {
        let line: Vec<&str> = ["xdotool"].into_iter().chain(words.split(' ')).collect();
        self.screen.tool(&line);
    }

    /// Drags with a button from one place of the window to another.
    pub(crate) fn drag(&self, button: u32, from: (i32, i32), to: (i32, i32)) {
        let ((x0, y0), (x1, y1)) = (from, to);
        self.hand(&format!("mousemove {x0} {y0} mousedown {button}"));
        self.hand(&format!("mousemove {x1} {y1} mouseup {button}"));
    }

    /// Changes the window's size.
    pub(crate) fn resize(&self, width: u32, height: u32) {
        let (width, height) = (width.to_string(), height.to_string());
        self.screen
            .tool(&["xdotool", "windowsize", &self.id, &width, &height]);
    }

    /// The window's title.
    pub(crate) fn title(&self) -> String {
        let title = self.screen.tool(&["xdotool", "getwindowname", &self.id]);
        String::from_utf8(title).unwrap().trim().to_owned()
    }

    /// The window's pixels.
    pub(crate) fn picture(&self) -> Picture {
        let dump = self.screen.tool(&["xwd", "-silent", "-id", &self.id]);
        // X Window Dump, version 7: numbers of four bytes, the highest first.
        let number = |place: usize| {
            let bytes: [u8; 4] = dump[4 * place..4 * place + 4].try_into().unwrap();
            bytes
                .iter()
                .fold(0, |sum, &byte| sum << 8 | usize::from(byte))
        };
        let [header, width, height] = [number(0), number(4), number(5)];
        let [is_high_first, bits, stride, colours] =
            [number(7), number(11), number(12), number(19)];
        assert_eq!((number(1), bits, is_high_first), (7, 32, 0));
        let start = header + 12 * colours;
        let rows = dump[start..].chunks(stride).take(height);
        let bytes = rows.flat_map(|row| row.as_chunks::<4>().0[..width].iter());
        Picture {
            width: width as u32,
            height: height as u32,
            bytes: bytes
                .flat_map(|&[blue, green, red, _]| [red, green, blue])
                .collect(),
        }
    }

    /// Waits until the window shows a picture.
    pub(crate) fn shows(&self, expected: &Picture) {
        wait_until("the expected picture", || self.picture() == *expected);
    }

    /// Waits until the window shows something that is true of its picture.
    pub(crate) fn shows_what(&self, what: &str, is_so: impl Fn(&Picture) -> bool) -> Picture {
        wait_for(what, || {
            Some(self.picture()).filter(|picture| is_so(picture))
        })
    }

    /// The picture once the camera is at rest: it is the same for longer than it takes to come to rest.
    pub(crate) fn at_rest(&self) -> Picture {
        let mut last = self.picture();
        let mut same = 0;
        wait_until("rest", || {
            thread::sleep(Duration::from_millis(100));
            let now = self.picture();
            same = if now == last { same + 1 } else { 0 };
            last = now;
            same == 12
        });
        last
    }

    /// Waits until the program ends.
    pub(crate) fn ends(mut self) -> Output {
        let mut child = self.child.take().unwrap();
        wait_until("the end of the program", || {
            child.try_wait().unwrap().is_some()
        });
        child.wait_with_output().unwrap()
    }
}

impl Drop for Window {
    fn drop(&mut self) {
        if let Some(child) = &mut self.child {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Waits until something is there, and returns it.
pub(crate) fn wait_for<T>(what: &str, mut find: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(found) = find() {
            return found;
        }
        assert!(start.elapsed() < PATIENCE, "{what} did not come");
        thread::sleep(Duration::from_millis(20));
    }
}

/// Waits until something is so.
pub(crate) fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    wait_for(what, || is_so().then_some(()));
}

/// A built-in scene as a picture of the window's size, seen by a camera that was steered.
pub(crate) fn steered(name: &str, steer: impl FnOnce(&mut Navigator)) -> Scene {
    let (width, height) = SIZE;
    let scene = Scene::builtin(name)
        .unwrap()
        .with_size(width, height)
        .unwrap();
    let mut navigator = Navigator::new(&scene);
    steer(&mut navigator);
    scene.with_camera(navigator.camera()).unwrap()
}

/// The scene's picture, drawn by the library: in colour, or as a mask.
pub(crate) fn drawn(scene: &Scene) -> Picture {
    let form = if scene.shows_colour() {
        Form::Rgb8
    } else {
        Form::Grey8
    };
    let needs = Needs::new(scene, &View::new(scene), form);
    let table: &Table = table(needs.table().unwrap().name);
    let mut renderer = Renderer::new(table);
    let bytes = if scene.shows_colour() {
        renderer.render_rgb(scene).unwrap().into_raw()
    } else {
        let mask = renderer.render(scene).unwrap().into_raw();
        mask.into_iter().flat_map(|grey| [grey; 3]).collect()
    };
    Picture {
        width: scene.image().width,
        height: scene.image().height,
        bytes,
    }
}

/// A picture in a file.
pub(crate) fn read(path: &Path) -> Picture {
    let picture = image::open(path).unwrap().to_rgb8();
    Picture {
        width: picture.width(),
        height: picture.height(),
        bytes: picture.into_raw(),
    }
}
