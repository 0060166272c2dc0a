//! Reads star catalogues.

use std::fs::File;
use std::path::Path;

use super::columns::Columns;
use super::fault::{BadRow, BadRows, CatalogueError, CatalogueFault};
use super::record::{LineReader, Record};
use super::star::{Star, StarField};

/// So many bad rows are kept with their reasons; others are only counted.
const MOST_REPORTED: usize = 20;

/// When the list of stars is full, it moves to another of twice the size: both exist for a moment.
const BYTES_PER_STAR: usize = 3 * size_of::<Star>();

impl StarField {
    /// Reads a catalogue. Stars fainter than `magnitude_limit` are dropped. The stars take at most `max_bytes` of
    /// memory.
    ///
    /// # Errors
    /// The file cannot be read, is no regular file, has no valid header, has no valid row, or needs more memory.
    pub fn read(
        path: &Path,
        magnitude_limit: Option<f64>,
        max_bytes: u64,
    ) -> Result<(Self, BadRows), CatalogueError> {
        read(path, magnitude_limit, max_bytes).map_err(|fault| CatalogueError {
            path: path.to_owned(),
            fault,
        })
    }
}

fn read(
    path: &Path,
    magnitude_limit: Option<f64>,
    max_bytes: u64,
) -> Result<(StarField, BadRows), CatalogueFault> {
    // Opening a pipe would wait for a writer.
    if !path.metadata()?.is_file() {
        return Err(CatalogueFault::NotAFile);
    }
    let most_stars = usize::try_from(max_bytes).unwrap_or(usize::MAX) / BYTES_PER_STAR;
    let magnitude_limit = magnitude_limit.unwrap_or(f64::INFINITY);
    let mut lines = LineReader::new(File::open(path)?);
    let mut record = Record::new();
    let columns = Columns::read(&mut lines, &mut record)?;
    let mut stars = Vec::new();
    let mut bad_rows = BadRows::default();
    let mut has_good_row = false;
    while lines.next()? {
        let row = record
            .parse(&lines.line)
            .and_then(|()| columns.values(&record));
        match row {
            Ok(row) => {
                has_good_row = true;
                if row.magnitude > magnitude_limit {
                    continue;
                }
                if stars.len() == most_stars {
                    return Err(CatalogueFault::TooManyStars {
                        stars: most_stars,
                        bytes: max_bytes,
                    });
                }
                stars.push(row.star());
            }
            Err(reason) => {
                bad_rows.count += 1;
                if bad_rows.first.len() < MOST_REPORTED {
                    let line = lines.number;
                    bad_rows.first.push(BadRow { line, reason });
                }
            }
        }
    }
    if !has_good_row {
        return Err(CatalogueFault::NoStar(bad_rows.first.into_iter().next()));
    }
    stars.shrink_to_fit();
    Ok((StarField { stars }, bad_rows))
}

#[cfg(test)]
mod tests {
    use super::super::columns::{DEFAULT_TEMPERATURE, temperature_of_colour_index};
    use super::super::fault::LONGEST_LINE;
    use super::*;

    fn read_bytes(
        bytes: impl AsRef<[u8]>,
        limit: Option<f64>,
        max_bytes: u64,
    ) -> Result<(StarField, BadRows), CatalogueError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("stars.csv");
        std::fs::write(&path, bytes).unwrap();
        StarField::read(&path, limit, max_bytes)
    }

    fn read_text(text: &str) -> (StarField, BadRows) {
        read_bytes(text, None, 1 << 20).unwrap()
    }

    fn fault(bytes: impl AsRef<[u8]>) -> CatalogueFault {
        read_bytes(bytes, None, 1 << 20).unwrap_err().fault
    }

    #[test]
    fn columns_come_in_any_order_and_case() {
        let (field, bad) = read_text(
            "\u{feff}# a comment\r\n\r\n Mag ,\"Name, or other\",DEC,B-V, Ra,teff\r\n\
             2.5,\"a, b\",0,,90,4000\r\n# another\r\n5,,-90,0.656,0\r\n0,x,30,,-330,",
        );
        assert_eq!(bad, BadRows::default());
        let expected = [
            Star::new(90.0, 0.0, 2.5, 4000.0),
            Star::new(0.0, -90.0, 5.0, temperature_of_colour_index(0.656)),
            Star::new(30.0, 30.0, 0.0, DEFAULT_TEMPERATURE),
        ];
        for (star, expected) in field.stars.iter().zip(expected) {
            assert!((star.direction - expected.direction).length() < 1e-15);
            assert_eq!(star.temperature, expected.temperature);
            assert_eq!(star.irradiance, expected.irradiance);
        }
        assert_eq!(field.stars.len(), 3);
        assert!((field.stars[0].irradiance - 0.1).abs() < 1e-8);
        assert!((field.stars[0].direction - glam::DVec3::Y).length() < 1e-15);
        assert!((field.stars[1].direction + glam::DVec3::Z).length() < 1e-15);
    }

    #[test]
    fn bad_rows_are_named_and_others_go_on() {
        let (field, bad) = read_text(
            "ra,dec,mag,temperature,bv\n1,2,3,5000,\nx,2,3,,\n1,91,3,,\n1,2,3,99,\n1,2,3,1e10,\n1,2,3,,4.1\n\
             1,,3,,\n1,2\n1,2,nan,,\ninf,2,3,,\n\"1,2,3\n# no row\n1,2,61,,\n1,2,3,x,1\n4,5,6,,1\n",
        );
        assert_eq!(field.stars.len(), 2);
        let found: Vec<String> = bad.first.iter().map(ToString::to_string).collect();
        let expected = [
            "line 3: ra = \"x\" is not a number",
            "line 4: dec = 91 is not within -90 to 90",
            "line 5: temperature = 99 is not within 100 to 1000000000",
            "line 6: temperature = 1e10 is not within 100 to 1000000000",
            "line 7: B−V = 4.1 is not within -0.4 to 4",
            "line 8: dec is missing",
            "line 9: magnitude is missing",
            "line 10: magnitude = \"nan\" is not a number",
            "line 11: ra = \"inf\" is not a number",
            "line 12: a quotation mark is not closed",
            "line 14: magnitude = 61 is not within -60 to 60",
            "line 15: temperature = \"x\" is not a number",
        ];
        assert_eq!(found, expected);
        assert_eq!(bad.count, expected.len() as u64);
    }

    #[test]
    fn many_bad_rows_are_counted() {
        let text = format!("ra,dec,mag,bv\n1,2,3,4\n{}", "bad\n".repeat(1000));
        let (field, bad) = read_text(&text);
        assert_eq!(
            (field.stars.len(), bad.count, bad.first.len()),
            (1, 1000, 20)
        );
    }

    #[test]
    fn faint_stars_are_dropped() {
        let text = "ra,dec,mag,bv\n1,2,3,1\n1,2,4,1\n1,2,4.5,1\n";
        let count = |limit| {
            let (field, bad) = read_bytes(text, Some(limit), 1 << 20).unwrap();
            assert_eq!(bad.count, 0);
            field.stars.len()
        };
        assert_eq!([5.0, 4.0, 2.0].map(count), [3, 2, 0]);
    }

    #[test]
    fn what_is_no_catalogue_is_refused() {
        use CatalogueFault as Fault;
        let missing = StarField::read(Path::new("no-such.csv"), None, 0).unwrap_err();
        assert!(matches!(missing.fault, Fault::Read(_)));
        assert!(missing.to_string().contains("no-such.csv"));
        for place in [Path::new("."), Path::new("/dev/zero")] {
            if place.exists() {
                let error = StarField::read(place, None, 1 << 20).unwrap_err();
                assert!(matches!(error.fault, Fault::NotAFile), "{error}");
            }
        }
        assert!(matches!(fault(""), Fault::NoHeader));
        assert!(matches!(fault("# only\n\n"), Fault::NoHeader));
        assert!(matches!(
            fault("ra,mag,bv\n1,2,3\n"),
            Fault::NoColumn {
                line: 1,
                column: "dec"
            }
        ));
        assert!(matches!(
            fault("#\nra,dec,mag\n1,2,3\n"),
            Fault::NoColumn {
                line: 2,
                column: "temperature or bv"
            }
        ));
        assert!(matches!(
            fault("ra,dec,mag,magnitude,bv\n"),
            Fault::TwoColumns {
                column: "magnitude",
                ..
            }
        ));
        assert!(matches!(fault("ra,dec,mag,bv\n"), Fault::NoStar(None)));
        assert!(matches!(
            fault("ra,dec,mag,bv\nx,1,1,1\n"),
            Fault::NoStar(Some(_))
        ));
        assert!(matches!(fault(b"r\xe9,dec\n"), Fault::BadHeader { .. }));
        assert!(matches!(fault([0; 100]), Fault::BadHeader { .. }));
        assert!(matches!(fault("\"ra,dec\n\",1\n"), Fault::BadHeader { .. }));
        assert!(matches!(
            fault(vec![b'a'; LONGEST_LINE]),
            Fault::LongLine(1)
        ));
        assert!(matches!(fault("a,".repeat(2000)), Fault::BadHeader { .. }));
        // Lines that end with a carriage return alone, as old editors wrote them.
        let old = fault("ra,dec,mag,bv\r1,2,3,1\r4,5,6,1\r");
        assert!(matches!(old, Fault::BadHeader { line: 1, .. }), "{old}");
        assert!(old.to_string().contains("carriage return"), "{old}");
    }

    #[test]
    fn no_star_is_lost_after_a_carriage_return() {
        let (field, bad) = read_text("ra,dec,mag,bv\r\n1,2,3,1\r4,5,6,1\n7,8,9,1 \r\n7,8,9,1\r");
        assert_eq!(field.stars.len(), 2);
        assert_eq!((bad.count, bad.first[0].line), (1, 2));
        assert!(bad.first[0].reason.contains("carriage return"));
    }

    #[test]
    fn memory_is_bounded() {
        let text = format!("ra,dec,mag,bv\n{}", "1,2,3,4\n".repeat(100));
        let error = read_bytes(&text, None, 99 * BYTES_PER_STAR as u64).unwrap_err();
        assert!(matches!(
            error.fault,
            CatalogueFault::TooManyStars { stars: 99, .. }
        ));
        let (field, _) = read_bytes(&text, None, 100 * BYTES_PER_STAR as u64).unwrap();
        assert_eq!(field.stars.len(), 100);
    }
}
