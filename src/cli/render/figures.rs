//! The figures of what frames need, as ranges over the frames.

use std::collections::BTreeMap;
use std::fmt::{self, Write as _};

use super::super::method::Method;
use super::draw;
use crate::isoradial::EscapeCurve;
use crate::render::Form;
use crate::render::needs::Needs;
use crate::scene::{ImageSize, Scene, View};

/// A figure of several frames.
#[derive(Debug, Clone, Copy)]
struct Span {
    least: f64,
    most: f64,
    /// The first frame in which it is greatest.
    frame: i64,
    /// In how many frames there is one.
    count: usize,
}

impl Default for Span {
    fn default() -> Self {
        Self {
            least: f64::INFINITY,
            most: f64::NEG_INFINITY,
            frame: 0,
            count: 0,
        }
    }
}

impl Span {
    /// Takes the figure of one more frame.
    fn add(&mut self, frame: i64, value: f64) {
        self.count += 1;
        self.least = self.least.min(value);
        if value > self.most {
            (self.most, self.frame) = (value, frame);
        }
    }
}

/// The range, to two digits, and the frame in which the figure is greatest; one number where it is the same in all.
impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let show = |value: f64| {
            if (1.0..1e9).contains(&value) && libm::rint(value) == value {
                format!("{value}")
            } else {
                figure(value)
            }
        };
        let (least, most) = (show(self.least), show(self.most));
        if least == most {
            f.write_str(&most)
        } else {
            write!(f, "{least} to {most} (frame {})", self.frame)
        }
    }
}

/// What frames need.
#[derive(Debug, Default)]
pub(super) struct Figures {
    frames: usize,
    sensitivity: Span,
    /// The thickness in pixels, and the nodes, of each order.
    orders: BTreeMap<u32, (Span, Span)>,
    /// The thickness in pixels of each order from which on orders are left out.
    left_out: BTreeMap<u32, Span>,
    /// The bytes and the nodes of the curves.
    curves: (Span, Span),
    /// The error of an edge in pixels: all of it, between nodes, from the angles, from rounding.
    errors: [Span; 4],
    /// The nodes, the bytes and the error of the map of the radius.
    map: [Span; 3],
    /// The octaves, the nodes and the bytes of the escape curve.
    escape: [Span; 3],
    /// The error of a direction, in radians.
    direction: f64,
}

impl Figures {
    /// Takes the figures of one more frame.
    pub(super) fn add(&mut self, frame: i64, scene: &Scene, form: Form, method: &Method) {
        let view = View::new(scene);
        let needs = Needs::new(scene, &view, form);
        let curves = draw::curves(&needs, method);
        self.frames += 1;
        self.sensitivity.add(frame, needs.sensitivity);
        for order in curves.orders() {
            let (thickness, nodes) = self.orders.entry(order.number()).or_default();
            thickness.add(frame, order.thickness());
            nodes.add(frame, order.nodes() as f64);
        }
        if let Some(thin) = curves.left_out() {
            let thickness = self.left_out.entry(thin.order).or_default();
            thickness.add(frame, thin.thickness);
        }
        self.curves.0.add(frame, curves.bytes() as f64);
        self.curves.1.add(frame, curves.nodes() as f64);
        let error = curves.error();
        let parts = [
            error.total(),
            error.interpolation,
            error.angles,
            error.rounding,
        ];
        add(&mut self.errors, frame, parts);
        if form.needs_map(scene) && scene.disk().is_some() {
            let map = draw::map(&curves, method);
            let figures = [map.nodes() as f64, map.bytes() as f64, map.error()];
            add(&mut self.map, frame, figures);
        }
        if form.needs_escape(scene) {
            let curve = draw::escape_curve(&view, method);
            let figures = [curve.octaves(), curve.nodes(), curve.bytes()];
            add(&mut self.escape, frame, figures.map(|figure| figure as f64));
            // A direction is as far off as the angle that its ray sweeps.
            let of_angles = match method {
                Method::Table(table) => table.metadata().measured_error,
                _ => 0.0,
            };
            self.direction = of_angles + EscapeCurve::INTERPOLATION_ERROR;
        }
    }

    /// The lines of all figures; `scene` is the first frame's.
    pub(super) fn lines(&self, scene: &Scene, form: Form) -> String {
        let mut text = String::new();
        let mut line = |label: &str, line: String| push_line(&mut text, label, &line);
        let of_frames = |span: &Span| match span.count {
            count if count == self.frames => String::new(),
            count => format!(", in {count} of {} frames", self.frames),
        };
        let has_disk = scene.disk().is_some();
        if has_disk {
            let each = &self.sensitivity;
            let what =
                format!("move by at most {each} pixels for each radian of error in an angle");
            line("edges", what);
        }
        let mut label = "orders";
        for (number, (thickness, nodes)) in &self.orders {
            let share = of_frames(thickness);
            line(
                label,
                format!("{number}: at most {thickness} pixels thick, {nodes} nodes{share}"),
            );
            label = "";
        }
        if self.orders.is_empty() {
            let why = if has_disk {
                "none: the disk is not in the picture"
            } else {
                "none: the scene has no disk"
            };
            line(label, why.into());
        }
        for (number, thickness) in &self.left_out {
            let share = of_frames(thickness);
            line(
                "",
                format!("{number} and up are left out, at most {thickness} pixels thick{share}"),
            );
        }
        let ImageSize { width, height } = scene.size();
        let pixels = u64::from(width) * u64::from(height) * form.bytes() as u64;
        if has_disk {
            let (bytes, nodes) = &self.curves;
            let what = format!("{bytes} of curves with {nodes} nodes, {pixels} of pixels");
            line("bytes", what);
            let [total, between, angles, rounding] = &self.errors;
            line(
                "edge error",
                format!(
                    "at most {total} pixels: {between} between nodes, {angles} from the angles, \
                     {rounding} from rounding"
                ),
            );
        } else {
            line("bytes", format!("{pixels} of pixels"));
        }
        let [nodes, bytes, error] = &self.map;
        if nodes.count > 0 {
            let what =
                format!("{nodes} nodes, {bytes} bytes, radii right to {error} of themselves");
            line("map", format!("of the radius: {what}"));
        }
        let [octaves, nodes, bytes] = &self.escape;
        if octaves.count > 0 {
            let error = self.direction;
            line(
                "escape",
                format!(
                    "{octaves} octaves towards the critical ray: {nodes} nodes, {bytes} bytes, \
                     directions right to {error:.1e} rad"
                ),
            );
        }
        text
    }
}

/// Takes the figures of one more frame.
fn add<const N: usize>(spans: &mut [Span; N], frame: i64, figures: [f64; N]) {
    for (span, figure) in spans.iter_mut().zip(figures) {
        span.add(frame, figure);
    }
}

/// Adds a line to an explanation.
pub(super) fn push_line(text: &mut String, label: &str, line: &str) {
    let _ = writeln!(text, "{label:<12}{line}");
}

/// A number with two significant digits.
pub(super) fn figure(value: f64) -> String {
    if value == 0.0 {
        "0".into()
    } else if (1e-3..1e5).contains(&value) {
        let digits = (1.0 - libm::floor(libm::log10(value))).max(0.0) as usize;
        format!("{value:.digits$}")
    } else {
        format!("{value:.1e}")
    }
}
