//! Logarithmic axes, and the frame of a plot.

use super::DrawError;
use super::canvas::{BELOW, Canvas, LEFT_OF, RIGHT_BELOW};
use super::style::{BLACK, GREY, LIGHT, bold, plain, words};

/// A logarithmic axis: where its decades are on the page.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axis {
    /// log10 of its ends.
    pub(super) decades: (f64, f64),
    /// Where they are, in pixels.
    pub(super) pixels: (f64, f64),
}

impl Axis {
    /// Whole decades that hold all `values` above 0.
    pub(super) fn about(values: impl Iterator<Item = f64>, pixels: (f64, f64)) -> Self {
        let (least, greatest) = values
            .filter(|value| *value > 0.0 && value.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                let decade = libm::log10(value);
                (low.min(decade), high.max(decade))
            });
        let decades = if least <= greatest {
            (
                least.floor(),
                (greatest + 1e-9).ceil().max(least.floor() + 1.0),
            )
        } else {
            (0.0, 1.0)
        };
        Self { decades, pixels }
    }

    /// Where `value` is; at the nearer end where it lies beyond.
    pub(super) fn at(self, value: f64) -> f64 {
        let (low, high) = self.decades;
        let decade = libm::log10(value.max(f64::MIN_POSITIVE)).clamp(low, high);
        self.at_decade(decade)
    }

    /// Where 10 to the `decade` is.
    pub(super) fn at_decade(self, decade: f64) -> f64 {
        let ((low, high), (from, to)) = (self.decades, self.pixels);
        from + (to - from) * ((decade - low) / (high - low))
    }

    /// The decades to be labelled: every one, or every second, third … where they are closer than `spacing` pixels.
    pub(super) fn ticks(self, spacing: f64) -> Vec<Tick> {
        let (low, high) = (self.decades.0.ceil() as i32, self.decades.1.floor() as i32);
        let room = (self.pixels.1 - self.pixels.0).abs() / (self.decades.1 - self.decades.0);
        let every = (spacing / room).ceil().max(1.0) as i32;
        (low..=high)
            .filter(|decade| decade % every == 0)
            .map(|decade| Tick {
                at: self.at_decade(f64::from(decade)),
                words: power_of_ten(decade),
            })
            .collect()
    }

    /// Round numbers evenly spread, `most` at most, for an axis shorter than a decade or two.
    pub(super) fn even_ticks(self, most: f64) -> Vec<Tick> {
        let (low, high) = (
            libm::pow(10.0, self.decades.0),
            libm::pow(10.0, self.decades.1),
        );
        let rough = (high - low) / most;
        let power = libm::pow(10.0, libm::floor(libm::log10(rough)));
        let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
        let step = steps
            .into_iter()
            .find(|step| *step >= rough)
            .unwrap_or(rough);
        let digits = (-libm::floor(libm::log10(step * 1.000_001))).max(0.0) as usize;
        let first = (low / step).ceil() as i64;
        let last = (high / step).floor() as i64;
        (first..=last)
            .map(|k| k as f64 * step)
            .map(|value| Tick {
                at: self.at(value),
                words: format!("{value:.digits$}"),
            })
            .collect()
    }
}

/// A place on an axis, and what it is called.
#[derive(Debug, Clone)]
pub(super) struct Tick {
    /// In pixels.
    pub(super) at: f64,
    pub(super) words: String,
}

/// `10⁻⁹`.
pub(super) fn power_of_ten(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let plain = exponent.to_string();
    let raised = plain.chars().map(|c| match c {
        '-' => '⁻',
        digit => digit
            .to_digit(10)
            .and_then(|digit| DIGITS.get(digit as usize).copied())
            .unwrap_or(digit),
    });
    let raised: String = raised.collect();
    match exponent {
        0 => "1".into(),
        1 => "10".into(),
        2 => "100".into(),
        _ => format!("10{raised}"),
    }
}

/// A plot's two axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plot {
    pub(super) x: Axis,
    /// Its pixels run from the bottom to the top.
    pub(super) y: Axis,
}

impl Plot {
    /// Where a point of the plot is on the page.
    pub(super) fn at(&self, x: f64, y: f64) -> (f64, f64) {
        (self.x.at(x), self.y.at(y))
    }

    /// Left, top, right, bottom.
    pub(super) fn corners(&self) -> (f64, f64, f64, f64) {
        (
            self.x.pixels.0,
            self.y.pixels.1,
            self.x.pixels.1,
            self.y.pixels.0,
        )
    }

    /// The lines of the x axis' ticks and of the y axis' decades, their labels, and the frame.
    pub(super) fn frame(
        &self,
        canvas: &Canvas<'_>,
        x: &[Tick],
        y_labels: bool,
    ) -> Result<(), DrawError> {
        self.rows(canvas, y_labels)?;
        self.sides(canvas, x)
    }

    /// The lines of the x axis' ticks, their labels, and the frame.
    pub(super) fn sides(&self, canvas: &Canvas<'_>, x: &[Tick]) -> Result<(), DrawError> {
        let (left, top, right, bottom) = self.corners();
        for tick in x {
            canvas.line(&[(tick.at, top), (tick.at, bottom)], plain(LIGHT, 0.8))?;
            canvas.text(
                &tick.words,
                (tick.at, bottom + 5.0),
                words(12.0, BLACK),
                BELOW,
            )?;
        }
        canvas.line(
            &[
                (left, top),
                (right, top),
                (right, bottom),
                (left, bottom),
                (left, top),
            ],
            plain(GREY, 1.0),
        )
    }

    /// The lines of the y axis' decades, and their labels.
    pub(super) fn rows(&self, canvas: &Canvas<'_>, labels: bool) -> Result<(), DrawError> {
        let (left, _, right, _) = self.corners();
        for tick in self.y.ticks(18.0) {
            canvas.line(&[(left, tick.at), (right, tick.at)], plain(LIGHT, 0.8))?;
            if labels {
                let at = (left - 6.0, tick.at);
                canvas.text(&tick.words, at, words(12.0, BLACK), LEFT_OF)?;
            }
        }
        Ok(())
    }

    /// The axes' names.
    pub(super) fn names(&self, canvas: &Canvas<'_>, x: &str, y: &str) -> Result<(), DrawError> {
        let (left, top, right, bottom) = self.corners();
        let (middle, centre) = (0.5 * (left + right), 0.5 * (top + bottom));
        canvas.text(x, (middle, bottom + 24.0), words(13.0, BLACK), BELOW)?;
        canvas.upward_text(y, (left - 50.0, centre), words(13.0, BLACK))
    }
}

/// Letters of a caption's line: no wider than the page in any usual font.
const LINE: usize = 156;

/// A panel's title, and below it what it shows. Returns where that ends.
pub(super) fn heading(
    canvas: &Canvas<'_>,
    at: (f64, f64),
    title: &str,
    caption: &str,
) -> Result<f64, DrawError> {
    canvas.text(title, at, bold(16.0, BLACK), RIGHT_BELOW)?;
    let mut y = at.1 + 24.0;
    let mut line = String::new();
    for word in caption.split(' ') {
        if line.chars().count() + word.chars().count() > LINE {
            canvas.text(&line, (at.0, y), words(12.0, GREY), RIGHT_BELOW)?;
            y += 16.0;
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line += word;
    }
    canvas.text(&line, (at.0, y), words(12.0, GREY), RIGHT_BELOW)?;
    Ok(y + 16.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_written_raised() {
        assert_eq!(power_of_ten(-12), "10⁻¹²");
        assert_eq!(power_of_ten(3), "10³");
        assert_eq!(power_of_ten(0), "1");
    }

    #[test]
    fn short_axes_have_round_ticks() {
        let axis = Axis {
            decades: (libm::log10(10.3), libm::log10(14.9)),
            pixels: (0.0, 100.0),
        };
        let words: Vec<_> = axis
            .even_ticks(5.0)
            .into_iter()
            .map(|tick| tick.words)
            .collect();
        assert_eq!(words, ["11", "12", "13", "14"]);
    }

    #[test]
    fn an_axis_holds_its_values_in_whole_decades() {
        let axis = Axis::about([3e-5, 0.0, 20.0].into_iter(), (100.0, 0.0));
        assert_eq!(axis.decades, (-5.0, 2.0));
        assert_eq!((axis.at(1e-5), axis.at(100.0)), (100.0, 0.0));
        assert_eq!(axis.at(0.0), 100.0);
    }
}
