//! Orbits of rays: swept angles by the exact method, by integration and from tables, compared with reference values,
//! closed forms, published series, quadrature, and each other.

#[path = "../common/natural.rs"]
mod natural;
#[path = "../common/quadrature.rs"]
mod quadrature;
#[path = "../common/reference_rays.rs"]
mod reference_rays;
#[path = "../common/tables.rs"]
mod tables;

mod flights;
mod known_values;

mod closed_forms;
mod extreme_rays;
mod grazing_rays;
mod integration;
mod paths;
mod stepping_fails;
mod swept_angles;
mod turning_points;
mod u_at_angle;
