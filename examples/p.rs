use darkness::isoradial::*;
use darkness::orbit::exact::Exact;
use darkness::render::{coverage, mask};
use darkness::scene::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    pool.install(|| {
        let s = Scene::builtin(&a[1]).unwrap();
        let v = View::new(&s);
        let c = Isoradials::new(&Sight::new(&s, &v, s.tolerance()), &Exact);
        let w = v.width() as usize;
        let mut px = vec![0u8; w * v.height() as usize];
        for _ in 0..a[3].parse::<u32>().unwrap() {
            if a[2] == "hard" {
                mask::render_into(&v, &c, &mut px, w).unwrap();
            } else {
                coverage::render_into(&v, &c, &mut px, w).unwrap();
            }
        }
    });
}
