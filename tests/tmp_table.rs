use darkness::orbit::{*, exact::Exact, invariants::*, path::*};
use darkness::table::*;
#[test]
fn rays() {
    for name in spec::Spec::NAMES {
    let spec = spec::Spec::named(name).unwrap();
    let t0=std::time::Instant::now();
    let numbers = tmp_numbers(&spec);
    println!("{name} {} bytes {:?}", numbers.len()*8, t0.elapsed());
    let look = tmp_lookup(&spec,&numbers);
    let text = std::fs::read_to_string("tests/reference/rays.csv").unwrap();
    let mut worst = std::collections::BTreeMap::<String,(f64,String)>::new();
    let mut n=0; let mut missing=0;
    for l in text.lines().skip(1) {
        let f: Vec<&str> = l.split(',').collect();
        let u: f64 = f[1].parse().unwrap(); let w: f64 = f[2].parse().unwrap();
        let r: f64 = f[4].parse().unwrap(); let t: f64 = f[5].parse().unwrap(); let c: f64 = f[6].parse().unwrap();
        let ev = look.follow(Ray::new(u,w).unwrap(), &[3.,6.,12.,30.]).unwrap();
        let kind = match f[3] {"capture"=>EventKind::End(Fate::Capture),"escape"=>EventKind::End(Fate::Escape),"inbound"=>EventKind::Inbound,_=>EventKind::Outbound};
        let Some(e) = ev.iter().find(|e| e.kind==kind && e.radius==r) else { missing+=1; println!("missing {l} {ev:?}"); continue };
        let ratio = (e.angle-t).abs()/(spec.tolerance+16.0*f64::EPSILON*c);
        n+=1;
        let en = worst.entry(f[0].into()).or_default();
        if !(ratio<=en.0) { *en=(ratio,format!("{l} got {:e}",e.angle)); }
    }
    println!("{n} {missing}"); for (k,v) in worst { println!("{k} {v:?}") }
    // dense per chart
    let mut seed = 12345u64; let mut rnd = || { seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407); (seed>>11) as f64/(1u64<<53) as f64 };
    let mut w = [(0.0f64,String::new()),(0.0,String::new()),(0.0,String::new()),(0.0,String::new())];
    for _ in 0..400000 {
        let x = rnd()*4.0; // 27e2/4
        let u: f64 = rnd()*rnd(); let u2=rnd();
        let e2: f64 = x*4.0/27.0*if rnd()<0.2 {rnd()*rnd()} else {1.0};
        let s = e2-u*u*(1.0-u); if s<0.0 {continue}
        let o = Orbit::new(Ray::new(u, s.sqrt()*if rnd()<0.5 {1.0} else {-1.0}).unwrap());
        let chart = if o.e2<0.64*4.0/27.0 { if u<0.6667 {1} else {2}} else if o.e2<12.0/27.0 {0} else {3};
        let d = (look.to_end(&o)-Exact.to_end(&o)).abs();
        if d > w[chart].0 { w[chart]=(d, format!("end {o:?}")); }
        let (a,b) = (look.crossings(&o,u2), Exact.crossings(&o,u2));
        for (a,b) in [(a.inbound,b.inbound),(a.outbound,b.outbound)] { if let (Some(a),Some(b))=(a,b) { let d=(a-b).abs(); if !(d <= w[chart].0) { w[chart]=(d, format!("{u2} {o:?}")); } } }
    }
    for x in w { println!("{x:?}"); }
    }
}
