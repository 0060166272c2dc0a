//! Published values, from `tests/reference/known_values.csv`.

/// One row of `tests/reference/known_values.csv`.
#[derive(Debug, Clone)]
pub(crate) struct KnownValue {
    /// What was computed.
    pub(crate) quantity: String,
    /// Of what.
    pub(crate) argument: String,
    /// The value, from a computation with 30 digits.
    pub(crate) value: f64,
    /// The figure in print, empty where there is none.
    pub(crate) published: String,
}

/// The rows of one quantity.
pub(crate) fn known_values(quantity: &str) -> Vec<KnownValue> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/reference/known_values.csv"
    );
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{path}: {error}"));
    let rows: Vec<_> = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .filter_map(|line| {
            let fields: Vec<&str> = line.splitn(5, ',').collect();
            let [name, argument, value, published, _source] = fields[..] else {
                panic!("{path}: not a row: {line}")
            };
            (name == quantity).then(|| KnownValue {
                quantity: name.to_owned(),
                argument: argument.to_owned(),
                value: value.parse().unwrap_or_else(|_| panic!("{path}: {line}")),
                published: published.to_owned(),
            })
        })
        .collect();
    assert!(!rows.is_empty(), "{path}: no {quantity}");
    rows
}
