//! Memory use, measured for the whole process: this binary has one test, so that no other runs beside it.

#[path = "../common/tables.rs"]
mod tables;

mod allocations;
mod resident_memory;

// One test, since both parts measure the whole process. The peak of memory is measured first.
#[test]
fn a_frame_takes_little_memory_beside_its_pixels_and_none_once_warm() {
    #[cfg(target_os = "linux")]
    resident_memory::a_frame_takes_little_more_than_its_bytes();
    allocations::a_crop_takes_no_memory_for_the_whole();
    allocations::frames_take_no_memory_once_warm();
    allocations::lit_frames_take_no_memory_once_warm();
    allocations::skies_take_no_memory_once_warm();
}
