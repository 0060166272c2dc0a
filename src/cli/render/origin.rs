//! What a frame was made of, as its file records it.

/// What a frame was made of: with the program's version, all that its bytes depend on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct FrameOrigin {
    /// The SHA-256 of the scene's TOML form, as hexadecimal digits.
    pub(super) scene: String,
    /// The SHA-256 of the table's file, or the name of the method in place of a table.
    pub(super) table: String,
    /// The SHA-256 of each of the sky's files, where the frame shows any.
    pub(super) sky: Option<String>,
    /// The frame's number.
    pub(super) frame: i64,
}

/// The key of the program's name and version.
pub(super) const SOFTWARE: &str = "Software";

/// The first bytes of a file, in which it says that this program made it.
pub(super) const HEAD: usize = 4096;

/// The program's name and version.
pub(super) const PROGRAM: &str = concat!("darkness ", env!("CARGO_PKG_VERSION"));

/// How [`PROGRAM`] begins in every version.
pub(super) const ANY_VERSION: &str = "darkness ";

impl FrameOrigin {
    /// The origin of another frame of the same animation.
    pub(super) fn of_frame(&self, frame: i64) -> Self {
        Self {
            frame,
            ..self.clone()
        }
    }

    /// The texts that a file records, as key and text.
    pub(super) fn texts(&self) -> Vec<(&'static str, String)> {
        let mut texts = vec![
            (SOFTWARE, PROGRAM.into()),
            ("darkness:scene", self.scene.clone()),
            ("darkness:table", self.table.clone()),
            ("darkness:frame", self.frame.to_string()),
        ];
        texts.extend(self.sky.clone().map(|sky| ("darkness:sky", sky)));
        texts
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The origin of a frame.
    pub(in super::super) fn origin(frame: i64) -> FrameOrigin {
        FrameOrigin {
            scene: "5c".repeat(32),
            table: "none".into(),
            sky: None,
            frame,
        }
    }

    /// Asserts that `is_ours` takes a frame's file for this program's, damaged beyond its head too, and takes no other
    /// file, nor one that another program or none names itself in.
    pub(in super::super) fn assert_only_ours_is_taken(
        file: &[u8],
        is_ours: impl Fn(&[u8]) -> bool,
    ) {
        let head = &file[..file.len().min(HEAD)];
        assert!(is_ours(head));
        let mut damaged = head.to_vec();
        *damaged.last_mut().unwrap() ^= 255;
        assert!(is_ours(&damaged));
        for length in [0, 1, 4, 8, 30] {
            assert!(!is_ours(&head[..length]), "{length}");
        }
        for at in 0..4 {
            let mut foreign = head.to_vec();
            foreign[at] ^= 1;
            assert!(!is_ours(&foreign), "byte {at}");
        }
        assert!(!is_ours(&vec![b'd'; HEAD]));
    }

    /// Asserts that `made` takes a frame's file for that frame's, and neither with any damage nor for another's.
    pub(in super::super) fn assert_no_other_is_taken(
        file: &[u8],
        origin: &FrameOrigin,
        made: impl Fn(&[u8], &FrameOrigin) -> bool,
    ) {
        assert!(made(file, origin));
        let others = [
            origin.of_frame(13),
            FrameOrigin {
                scene: "5d".repeat(32),
                ..origin.clone()
            },
            FrameOrigin {
                table: "exact".into(),
                ..origin.clone()
            },
            FrameOrigin {
                sky: Some("6e".repeat(32)),
                ..origin.clone()
            },
        ];
        assert!(others.iter().all(|other| !made(file, other)));
        for length in 0..file.len() {
            assert!(!made(&file[..length], origin), "{length}");
        }
        assert!(!made(&[file, b"\n"].concat(), origin));
        let mut damaged = file.to_vec();
        for at in 0..file.len() {
            for bit in 0..8 {
                damaged[at] ^= 1 << bit;
                assert!(!made(&damaged, origin), "byte {at}, bit {bit}");
                damaged[at] ^= 1 << bit;
            }
        }
    }
}
