use darkness::table::*;
#[test]
fn g() {
    for n in Spec::NAMES {
        let t = std::time::Instant::now();
        let x = generate(&Spec::named(n).unwrap(), &|_, _| ()).unwrap();
        let d = t.elapsed();
        let p = std::path::PathBuf::from(format!("/tmp/t/{n}.table"));
        save(&x, &p).unwrap();
        let t = std::time::Instant::now();
        let y = open(&p).unwrap();
        let o = t.elapsed();
        println!(
            "{n} {d:?} open {o:?} {} {:?}",
            x.bytes().len(),
            y.metadata()
        );
    }
    std::fs::write("/tmp/t/x.table", b"hello").unwrap();
    println!(
        "{}",
        open(std::path::Path::new("/tmp/t/x.table")).unwrap_err()
    );
}
