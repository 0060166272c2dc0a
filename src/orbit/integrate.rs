//! Direct integration.
