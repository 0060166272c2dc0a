use darkness::isoradial::*;
use darkness::orbit::exact::Exact;
use darkness::render::{coverage, mask};
use darkness::scene::*;
use std::time::Instant;
fn med(mut v: Vec<f64>) -> f64 {
    v.sort_by(f64::total_cmp);
    v[v.len() / 2]
}
fn main() {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    pool.install(||{
 let mut sc:Vec<_>=builtins().iter().map(|b|(b.name().to_string(),Scene::builtin(b.name()).unwrap())).collect();
 sc.push(("classic 8k".into(), Scene::builtin("classic").unwrap().with_size(7680,4320).unwrap()));
 for (name,s) in sc {
 let v=View::new(&s);
 let c=Isoradials::new(&Sight::new(&s,&v,s.tolerance()),&Exact);
 let w=v.width() as usize; let mut px=vec![0u8;w*v.height() as usize];
 let (mut a,mut b,mut d,mut e,mut g)=(vec![],vec![],vec![],vec![],vec![]);
 for _ in 0..41 {
  let t=Instant::now(); std::hint::black_box(&mut px).fill(0); a.push(t.elapsed().as_secs_f64());
  let t=Instant::now(); mask::render_into(&v,&c,&mut px,w).unwrap(); b.push(t.elapsed().as_secs_f64());
  let t=Instant::now(); coverage::render_into(&v,&c,&mut px,w).unwrap(); d.push(t.elapsed().as_secs_f64());
  let t=Instant::now(); darkness::render::cull(&v,&c,false,&mut px).unwrap(); e.push(t.elapsed().as_secs_f64());
  let t=Instant::now(); darkness::render::cull(&v,&c,true,&mut px).unwrap(); g.push(t.elapsed().as_secs_f64());
 }
 let (a,b,d,e,g)=(med(a),med(b),med(d),med(e),med(g));
 println!("{name:14} fill {:.3} ms  hard {:.3} ({:.1}x) cull {:.3}  smooth {:.3} ({:.1}x) cull {:.3}",a*1e3,b*1e3,b/a,e*1e3,d*1e3,d/a,g*1e3);
 }});
}
