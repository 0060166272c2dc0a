#[test]
fn micro() {
    let mut seed = 12345u64;
    let mut rnd = || {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    let xs: Vec<f64> = (0..20000).map(|_| rnd() * 3.0 + 0.01).collect();
    for _ in 0..3 {
        let t = std::time::Instant::now();
        let mut a = 0.0;
        for &x in &xs {
            a += libm::log(x);
        }
        println!("log {:?} {a}", t.elapsed() / 20000);
        let t = std::time::Instant::now();
        let mut a = 0.0;
        for &x in &xs {
            a += x.sqrt();
        }
        println!("sqrt {:?} {a}", t.elapsed() / 20000);
        let t = std::time::Instant::now();
        let mut a = 1.0;
        for &x in &xs {
            a = (x + a).sqrt();
        }
        println!("sqrt lat {:?} {a}", t.elapsed() / 20000);
        let t = std::time::Instant::now();
        let mut a = 1.0;
        for &x in &xs {
            a = x / (1.0 + a);
        }
        println!("div lat {:?} {a}", t.elapsed() / 20000);
        let t = std::time::Instant::now();
        let mut a = 0.0;
        for &x in &xs {
            a += libm::asin(x * 0.3) + libm::sin(x) + libm::cos(x);
        }
        println!("asin+sin+cos {:?} {a}", t.elapsed() / 20000);
        let t = std::time::Instant::now();
        let mut a = 0.0;
        for &x in &xs {
            a += darkness::orbit::carlson::rf(x, 1.0, 2.0);
        }
        println!("rf {:?} {a}", t.elapsed() / 20000);
    }
}
