//! One step of the Runge–Kutta method DOP853, of order 8 with error estimates of orders 5 and 3, on the orbit
//! equation.
//!
//! Source: Hairer, Nørsett & Wanner, *Solving Ordinary Differential Equations I*, 2nd ed., §II.5
//! (methods of order 8) and §II.10 (the error estimate), and their code `dop853.f`, which has the
//! coefficients.
#![allow(
    clippy::excessive_precision,
    reason = "the coefficients stand as published"
)]

use super::flight::{State, acceleration};

const STAGES: usize = 12;

/// `a_ij`: the weight of slope j in the state at which slope i + 1 is taken.
const A: [&[f64]; STAGES - 1] = [
    &[5.26001519587677318785587544488e-2],
    &[
        1.97250569845378994544595329183e-2,
        5.91751709536136983633785987549e-2,
    ],
    &[
        2.95875854768068491816892993775e-2,
        0.0,
        8.87627564304205475450678981324e-2,
    ],
    &[
        2.41365134159266685502369798665e-1,
        0.0,
        -8.84549479328286085344864962717e-1,
        9.24834003261792003115737966543e-1,
    ],
    &[
        3.7037037037037037037037037037e-2,
        0.0,
        0.0,
        1.70828608729473871279604482173e-1,
        1.25467687566822425016691814123e-1,
    ],
    &[
        3.7109375e-2,
        0.0,
        0.0,
        1.70252211019544039314978060272e-1,
        6.02165389804559606850219397283e-2,
        -1.7578125e-2,
    ],
    &[
        3.70920001185047927108779319836e-2,
        0.0,
        0.0,
        1.70383925712239993810214054705e-1,
        1.07262030446373284651809199168e-1,
        -1.53194377486244017527936158236e-2,
        8.27378916381402288758473766002e-3,
    ],
    &[
        6.24110958716075717114429577812e-1,
        0.0,
        0.0,
        -3.36089262944694129406857109825,
        -8.68219346841726006818189891453e-1,
        2.75920996994467083049415600797e1,
        2.01540675504778934086186788979e1,
        -4.34898841810699588477366255144e1,
    ],
    &[
        4.77662536438264365890433908527e-1,
        0.0,
        0.0,
        -2.48811461997166764192642586468,
        -5.90290826836842996371446475743e-1,
        2.12300514481811942347288949897e1,
        1.52792336328824235832596922938e1,
        -3.32882109689848629194453265587e1,
        -2.03312017085086261358222928593e-2,
    ],
    &[
        -9.3714243008598732571704021658e-1,
        0.0,
        0.0,
        5.18637242884406370830023853209,
        1.09143734899672957818500254654,
        -8.14978701074692612513997267357,
        -1.85200656599969598641566180701e1,
        2.27394870993505042818970056734e1,
        2.49360555267965238987089396762,
        -3.0467644718982195003823669022,
    ],
    &[
        2.27331014751653820792359768449,
        0.0,
        0.0,
        -1.05344954667372501984066689879e1,
        -2.00087205822486249909675718444,
        -1.79589318631187989172765950534e1,
        2.79488845294199600508499808837e1,
        -2.85899827713502369474065508674,
        -8.87285693353062954433549289258,
        1.23605671757943030647266201528e1,
        6.43392746015763530355970484046e-1,
    ],
];

/// `b_j`: the weights of order 8.
const B: [f64; STAGES] = [
    5.42937341165687622380535766363e-2,
    0.0,
    0.0,
    0.0,
    0.0,
    4.45031289275240888144113950566,
    1.89151789931450038304281599044,
    -5.8012039600105847814672114227,
    3.1116436695781989440891606237e-1,
    -1.52160949662516078556178806805e-1,
    2.01365400804030348374776537501e-1,
    4.47106157277725905176885569043e-2,
];

/// The weights of order 8 minus those of order 5.
const ERROR_5: [f64; STAGES] = [
    0.1312004499419488073250102996e-1,
    0.0,
    0.0,
    0.0,
    0.0,
    -0.1225156446376204440720569753e1,
    -0.4957589496572501915214079952,
    0.1664377182454986536961530415e1,
    -0.3503288487499736816886487290,
    0.3341791187130174790297318841,
    0.8192320648511571246570742613e-1,
    -0.2235530786388629525884427845e-1,
];

/// The weights of order 3, for the slopes 0, 8 and 11.
const ORDER_3: [f64; 3] = [
    0.244094488188976377952755905512,
    0.733846688281611857341361741547,
    0.0220588235294117647058823529412,
];

/// Computes the slopes (du/dφ, dw/dφ) at the stages of a step.
type Slopes = [[f64; 2]; STAGES];

fn weighted(weights: &[f64], slopes: &Slopes) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for (weight, slope) in weights.iter().zip(slopes) {
        sum[0] += weight * slope[0];
        sum[1] += weight * slope[1];
    }
    sum
}

fn slopes(from: State, h: f64) -> Slopes {
    let mut slopes = [[0.0; 2]; STAGES];
    slopes[0] = [from.w, acceleration(from.u)];
    for (i, row) in A.iter().enumerate() {
        let [du, dw] = weighted(row, &slopes);
        slopes[i + 1] = [from.w + h * dw, acceleration(from.u + h * du)];
    }
    slopes
}

fn arrive(from: State, h: f64, [du, dw]: [f64; 2]) -> State {
    State {
        u: from.u + h * du,
        w: from.w + h * dw,
    }
}

/// Computes the state an angle `h` on.
pub(super) fn step(from: State, h: f64) -> State {
    arrive(from, h, weighted(&B, &slopes(from, h)))
}

/// Computes the state an angle `h` on, and the estimated error of u and w together as a share of hypot(u, w).
///
/// The error of an angle depends on that share: where the orbit's slope is not small against u, an error δu moves every
/// later angle by about δu/|w| ≤ δu/hypot(u, w) times a constant, for far rays (u, w of 1e-12) as for near ones.
pub(super) fn step_with_error(from: State, h: f64) -> (State, f64) {
    let slopes = slopes(from, h);
    let order_8 = weighted(&B, &slopes);
    let order_5 = weighted(&ERROR_5, &slopes);
    let scale = libm::hypot(from.u, from.w);
    let (mut error_5, mut error_3) = (0.0, 0.0);
    for i in 0..2 {
        let five = order_5[i] / scale;
        let three = (order_8[i]
            - ORDER_3[0] * slopes[0][i]
            - ORDER_3[1] * slopes[8][i]
            - ORDER_3[2] * slopes[11][i])
            / scale;
        error_5 += five * five;
        error_3 += three * three;
    }
    // Hairer, Nørsett & Wanner, §II.10: falls as h⁸ where the two differences alone fall as h⁶ and h⁴.
    let denominator = error_5 + 0.01 * error_3;
    let error = if denominator > 0.0 {
        h.abs() * error_5 / (2.0 * denominator).sqrt()
    } else {
        0.0
    };
    (arrive(from, h, order_8), error)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The critical ray from infinity towards the photon sphere: `u = tanh²(x/2) − 1/3` (Chandrasekhar, §20).
    fn critical(x: f64) -> State {
        let tanh = libm::tanh(0.5 * x);
        State {
            u: tanh * tanh - 1.0 / 3.0,
            w: tanh * (1.0 - tanh * tanh),
        }
    }

    #[test]
    fn a_step_is_of_order_eight() {
        let miss = |h: f64| {
            let (arrived, truth) = (step(critical(1.5), h), critical(1.5 + h));
            libm::hypot(arrived.u - truth.u, arrived.w - truth.w)
        };
        // Over one step the error of a method of order 8 goes as h⁹; far above rounding at these lengths.
        for h in [0.6, 0.5] {
            let order = libm::log2(miss(h) / miss(0.5 * h)) - 1.0;
            assert!(
                (7.5..9.5).contains(&order),
                "order {order} at h = {h}, error {:e}",
                miss(h)
            );
        }
        // What is left at a short step is the rounding of both sides.
        assert!(miss(0.1) <= 2.0 * f64::EPSILON, "{:e}", miss(0.1));
    }

    #[test]
    fn the_error_estimate_is_an_upper_bound_that_falls_as_the_eighth_power() {
        for h in [0.8, 0.4] {
            let (arrived, estimate) = step_with_error(critical(1.5), h);
            let (from, truth) = (critical(1.5), critical(1.5 + h));
            let error =
                libm::hypot(arrived.u - truth.u, arrived.w - truth.w) / libm::hypot(from.u, from.w);
            assert!(
                error <= estimate,
                "h = {h}: error {error:e}, estimate {estimate:e}"
            );
            let halved = step_with_error(critical(1.5), 0.5 * h).1;
            let order = libm::log2(estimate / halved);
            assert!((6.5..9.5).contains(&order), "order {order} at h = {h}");
        }
    }
}
