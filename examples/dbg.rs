use darkness::isoradial::*;
use darkness::orbit::exact::Exact;
use darkness::render::coverage;
use darkness::scene::*;
fn main() {
    let t = "[camera]\nposition=[20,0,0]\nfocus=[0,0,0]\nfov=40.0\nup=[0,0,1]\n[disk]\ninner=3.0\nouter=12.0\nnormal=[0,0,1]\n[image]\nwidth=9\nheight=7\n";
    let s = Scene::from_toml(t).unwrap();
    let v = View::new(&s);
    let c = Isoradials::new(&Sight::new(&s, &v, s.tolerance()), &Exact);
    let f = coverage::render(&v, &c).unwrap();
    let e = coverage::render_every_pixel(&v, &c).unwrap();
    for r in 0..7 {
        println!("{:?} {:?}", &f[r * 9..r * 9 + 9], &e[r * 9..r * 9 + 9]);
    }
}
