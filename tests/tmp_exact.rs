use darkness::orbit::{exact::Exact, *};
#[test]
fn rays() {
    let text = std::fs::read_to_string("tests/reference/rays.csv").unwrap();
    let mut worst = std::collections::BTreeMap::<String, (f64, String)>::new();
    let mut n = 0;
    let mut missing = 0;
    for l in text.lines().skip(1) {
        let f: Vec<&str> = l.split(',').collect();
        let u: f64 = f[1].parse().unwrap();
        let w: f64 = f[2].parse().unwrap();
        let r: f64 = f[4].parse().unwrap();
        let t: f64 = f[5].parse().unwrap();
        let c: f64 = f[6].parse().unwrap();
        let ev = Exact
            .follow(Ray::new(u, w).unwrap(), &[3., 6., 12., 30.])
            .unwrap();
        let kind = match f[3] {
            "capture" => EventKind::End(Fate::Capture),
            "escape" => EventKind::End(Fate::Escape),
            "inbound" => EventKind::Inbound,
            _ => EventKind::Outbound,
        };
        let Some(e) = ev.iter().find(|e| e.kind == kind && e.radius == r) else {
            missing += 1;
            println!("missing {l} {ev:?}");
            continue;
        };
        let ratio = (e.angle - t).abs() / (1e-12 + 16.0 * f64::EPSILON * c);
        n += 1;
        let en = worst.entry(f[0].into()).or_default();
        if !(ratio <= en.0) {
            *en = (ratio, format!("{l} got {:e}", e.angle));
        }
    }
    println!("{n} {missing} {worst:#?}");
}
