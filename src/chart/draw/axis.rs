//! Logarithmic axes, and the frame of a plot.

use super::DrawError;
use super::canvas::{BELOW, Canvas, LEFT_OF};
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

    /// The decades to be labelled: every one, or every second, third … where there is little room.
    pub(super) fn ticks(self, spacing: f64) -> impl Iterator<Item = i32> {
        let (low, high) = (self.decades.0.ceil() as i32, self.decades.1.floor() as i32);
        let room = (self.pixels.1 - self.pixels.0).abs() / (self.decades.1 - self.decades.0);
        let every = (spacing / room).ceil().max(1.0) as i32;
        (low..=high).filter(move |decade| decade % every == 0)
    }
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

    /// The lines of both axes' decades, their labels, and the frame.
    pub(super) fn frame(
        &self,
        canvas: &Canvas<'_>,
        x_labels: bool,
        y_labels: bool,
    ) -> Result<(), DrawError> {
        let (left, top, right, bottom) = self.corners();
        for decade in self.x.ticks(44.0) {
            let x = self.x.at_decade(f64::from(decade));
            canvas.line(&[(x, top), (x, bottom)], plain(LIGHT, 0.8))?;
            if x_labels {
                canvas.text(
                    &power_of_ten(decade),
                    (x, bottom + 5.0),
                    words(12.0, BLACK),
                    BELOW,
                )?;
            }
        }
        self.rows(canvas, y_labels)?;
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
        for decade in self.y.ticks(18.0) {
            let y = self.y.at_decade(f64::from(decade));
            canvas.line(&[(left, y), (right, y)], plain(LIGHT, 0.8))?;
            if labels {
                canvas.text(
                    &power_of_ten(decade),
                    (left - 6.0, y),
                    words(12.0, BLACK),
                    LEFT_OF,
                )?;
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

/// A panel's title, and below it what it shows in one line.
pub(super) fn heading(
    canvas: &Canvas<'_>,
    at: (f64, f64),
    title: &str,
    caption: &[&str],
) -> Result<(), DrawError> {
    let start = (
        plotters::style::text_anchor::HPos::Left,
        plotters::style::text_anchor::VPos::Top,
    );
    canvas.text(title, at, bold(16.0, BLACK), start)?;
    for (i, line) in caption.iter().enumerate() {
        let below = (at.0, at.1 + 22.0 + 16.0 * i as f64);
        canvas.text(line, below, words(12.0, GREY), start)?;
    }
    Ok(())
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
    fn an_axis_holds_its_values_in_whole_decades() {
        let axis = Axis::about([3e-5, 0.0, 20.0].into_iter(), (100.0, 0.0));
        assert_eq!(axis.decades, (-5.0, 2.0));
        assert_eq!((axis.at(1e-5), axis.at(100.0)), (100.0, 0.0));
        assert_eq!(axis.at(0.0), 100.0);
    }
}
