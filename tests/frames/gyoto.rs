//! The redshift and the emission angle against another program: Gyoto (Vincent et al. 2011, Class. Quantum Grav. 28,
//! 225011), where it is installed (Debian's package gyoto-bin; `DARKNESS_TOOLS` naming `gyoto` demands it).
//!
//! Gyoto integrates rays in its own coordinates and takes the redshift from scalar products of four-vectors. It saves
//! where each pixel's ray meets the disk and both four-velocities there. The library's formulas need the radius and
//! the light's constant of motion λ alone.

use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use darkness::light::{emission_cosine, redshift};
use tempfile::tempdir;

use crate::process::finish;
use crate::tools;

/// A camera at rest (for a hole without spin, an observer of zero angular momentum) at r = 60 M, i.e. 30 Schwarzschild
/// radii.
const SCENE: &str = r#"<?xml version="1.0" encoding="UTF-8" standalone="no"?>
<Scenery>
  <Metric kind="KerrBL"><Spin> 0. </Spin></Metric>
  <Screen>
    <Position> 1000. 60. 1.2 0. </Position>
    <Time unit="geometrical_time"> 1000. </Time>
    <FieldOfView> 0.9 </FieldOfView>
    <Resolution> 40 </Resolution>
    <ObserverKind>ZAMO</ObserverKind>
  </Screen>
  <Astrobj kind="ThinDisk">
    <InnerRadius> 6. </InnerRadius>
    <OuterRadius> 24. </OuterRadius>
    <RMax> 100. </RMax>
  </Astrobj>
  <Quantities> Redshift ImpactCoords </Quantities>
  <MinimumTime> -3000. </MinimumTime>
</Scenery>
"#;

/// The camera's radius in Gyoto's unit, M.
const CAMERA: f64 = 60.0;

#[test]
fn redshift_and_emission_angle_equal_gyotos() {
    if !tools::has("gyoto") {
        return;
    }
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("scene.xml"), SCENE).unwrap();
    finish(Command::new("gyoto").current_dir(&folder).args([
        "--silent",
        "scene.xml",
        "image.fits",
    ]));
    let [redshifts, impacts] = images(&folder.path().join("image.fits"))
        .try_into()
        .expect("two images");
    assert_eq!(impacts.len(), 16 * redshifts.len());

    let clock_rate = (1.0 - 2.0 / CAMERA).sqrt();
    let (mut lit, mut worst) = (0, [0.0_f64; 2]);
    for (&gyotos, impact) in redshifts.iter().zip(impacts.chunks_exact(16)) {
        // t, r, θ, φ and their derivatives, of the disk's matter and of the light. DBL_MAX: nothing was met.
        let [_, r, _, _, dt, _, _, dphi] = impact[..8] else {
            unreachable!("eight numbers")
        };
        let [_, _, theta, _, light_dt, _, light_dtheta, light_dphi] = impact[8..] else {
            unreachable!("eight numbers")
        };
        if r >= f64::MAX {
            continue;
        }
        let (lapse2, rho) = (1.0 - 2.0 / r, r * libm::sin(theta));
        let energy = lapse2 * light_dt;
        // M is half a Schwarzschild radius.
        let lambda = 0.5 * rho * rho * light_dphi / energy;
        let across = 0.5 * r * r * light_dtheta.abs() / energy;
        let u = 2.0 / r;
        let g = redshift(u, clock_rate, lambda);
        worst[0] = worst[0].max((g / gyotos - 1.0).abs());

        let measured = energy * dt - rho * rho * dphi * light_dphi;
        let cosine = r * light_dtheta.abs() / measured;
        worst[1] = worst[1].max((emission_cosine(u, across, lambda) - cosine).abs());
        lit += 1;
    }
    println!(
        "{lit} lit pixels: redshift {:e}, emission cosine {:e}",
        worst[0], worst[1]
    );
    assert!(lit >= 400, "{lit} lit pixels");
    // What Gyoto's own steps leave of it: 2e-9 were seen.
    assert!(worst[0] <= 1e-7 && worst[1] <= 1e-7, "{worst:?}");
}

/// The numbers of each image in a FITS file whose images are of 64-bit floating-point numbers (FITS Standard 4.0, §3
/// and §4.4.1): blocks of 2880 bytes; a header of lines of 80 characters up to `END`, then big-endian numbers.
#[expect(clippy::big_endian_bytes, reason = "FITS is big-endian")]
fn images(file: &Path) -> Vec<Vec<f64>> {
    const BLOCK: usize = 2880;
    let bytes = fs::read(file).unwrap();
    let mut rest = &bytes[..];
    let mut images = Vec::new();
    while !rest.is_empty() {
        let mut header = HashMap::new();
        let mut lines = 0;
        for line in rest.chunks_exact(80) {
            lines += 1;
            let line = str::from_utf8(line).unwrap();
            if line.trim_end() == "END" {
                break;
            }
            if let Some((key, value)) = line.split_once('=') {
                let value = value.split('/').next().unwrap_or_default();
                header.insert(key.trim(), value.trim());
            }
        }
        assert_eq!(header["BITPIX"], "-64");
        let number = |key: String| -> usize { header[&key[..]].parse().unwrap() };
        let axes = number("NAXIS".into());
        let count: usize = (1..=axes).map(|k| number(format!("NAXIS{k}"))).product();
        rest = &rest[(80_usize * lines).next_multiple_of(BLOCK)..];
        let (numbers, _) = rest[..8 * count].as_chunks::<8>();
        images.push(
            numbers
                .iter()
                .map(|&bytes| f64::from_be_bytes(bytes))
                .collect(),
        );
        rest = &rest[(8 * count).next_multiple_of(BLOCK)..];
    }
    images
}
