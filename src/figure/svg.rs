//! Curves and outlines as SVG.

use std::fmt::Write;

use kurbo::{BezPath, PathEl, Point};

use super::contour::Contour;
use crate::scene::{ImageSize, Region, Scene};

/// Curves are as wide as this share of the picture's height.
const STROKE: f64 = 1.0 / 540.0;

/// What curves are drawn on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Paper<'a> {
    /// White paper, with dark curves.
    White,
    /// A PNG file, which fills what is drawn of the picture, with coloured curves.
    Png(&'a [u8]),
}

/// Returns curves in the drawn part of a scene's picture as an SVG document, one `path` each. Those of the direct image
/// are solid, those of higher orders dashed. The `class` of a path names its quantity and whether it is `direct` or a
/// `ghost`. Its `title` tells its level and order.
pub fn svg(contours: &[Contour], scene: &Scene, paper: Paper<'_>) -> String {
    let size = scene.image();
    let colours = match paper {
        Paper::White => ["#000", "#b2182b", "#2166ac"],
        // These are seen before black and before white.
        Paper::Png(_) => ["#00a2ff", "#ff6a00", "#1fae3f"],
    };
    let stroke = f64::from(size.height) * STROKE;
    let mut body = format!(
        "<style>path{{fill:none;stroke-width:{stroke:.3};stroke-linejoin:round}}\
         .radius{{stroke:{}}}.redshift{{stroke:{}}}.flux{{stroke:{}}}\
         .ghost{{stroke-dasharray:{:.3} {:.3}}}</style>\n",
        colours[0],
        colours[1],
        colours[2],
        4.0 * stroke,
        2.5 * stroke,
    );
    let ImageSize { width, height } = size;
    let part = scene.region();
    let place = match scene.crop() {
        Some(Region { left, top, .. }) => format!(" x=\"{left}\" y=\"{top}\""),
        None => String::new(),
    };
    match paper {
        Paper::White => push(
            &mut body,
            format_args!("<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n"),
        ),
        Paper::Png(bytes) => push(
            &mut body,
            format_args!(
                "<image{place} width=\"{}\" height=\"{}\" href=\"data:image/png;base64,{}\"/>\n",
                part.width,
                part.height,
                base64(bytes)
            ),
        ),
    }
    for Contour { level, order, path } in contours {
        let name = level.quantity.name();
        let image = if *order == 0 { "direct" } else { "ghost" };
        let value = level.value;
        push(
            &mut body,
            format_args!(
                "<path class=\"{name} {image}\" d=\"{}\"><title>{name} {value}, order {order}</title></path>\n",
                path_data(path)
            ),
        );
    }
    document(part, &body)
}

/// Returns the filled outline of a disk in the drawn part of a scene's picture as an SVG document: white on black, as
/// its mask.
pub fn outline_svg(outline: &BezPath, scene: &Scene) -> String {
    let ImageSize { width, height } = scene.image();
    let body = format!(
        "<rect width=\"{width}\" height=\"{height}\" fill=\"#000\"/>\n<path fill=\"#fff\" d=\"{}\"/>\n",
        path_data(outline)
    );
    document(scene.region(), &body)
}

/// Returns a document that shows a part of the picture, whose body is in the whole picture's coordinates.
fn document(part: Region, body: &str) -> String {
    let Region {
        left,
        top,
        width,
        height,
    } = part;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"{left} {top} {width} {height}\">\n<desc>darkness {}</desc>\n{body}</svg>\n",
        env!("CARGO_PKG_VERSION")
    )
}

/// Returns the `d` of a path, to a hundred-thousandth of a pixel.
fn path_data(path: &BezPath) -> String {
    let mut text = String::new();
    for element in path {
        match element {
            PathEl::MoveTo(p) => push_points(&mut text, 'M', &[p]),
            PathEl::LineTo(p) => push_points(&mut text, 'L', &[p]),
            PathEl::QuadTo(p, q) => push_points(&mut text, 'Q', &[p, q]),
            PathEl::CurveTo(p, q, r) => push_points(&mut text, 'C', &[p, q, r]),
            PathEl::ClosePath => text.push('Z'),
        }
    }
    text
}

fn push_points(text: &mut String, command: char, points: &[Point]) {
    text.push(command);
    for (i, point) in points.iter().enumerate() {
        let space = if i == 0 { "" } else { " " };
        push(text, format_args!("{space}{:.5},{:.5}", point.x, point.y));
    }
}

/// Appends formatted text. Writing to a `String` cannot fail.
fn push(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    let _ = text.write_fmt(arguments);
}

/// Returns bytes in base 64 (RFC 4648, section 4).
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |i: usize| u32::from(group.get(i).copied().unwrap_or_default());
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * i) & 63) as usize];
            text.push(if i <= group.len() { digit.into() } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::base64;

    #[test]
    fn base64_as_in_rfc_4648() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }
}
