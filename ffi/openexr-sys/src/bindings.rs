//! What bindgen makes of the shim's header and the installed `openexr.h`.
#![expect(
    clippy::allow_attributes,
    dead_code,
    non_camel_case_types,
    unreachable_pub,
    reason = "generated code keeps the names of C and whole enums"
)]

include!(concat!(env!("OUT_DIR"), "/bindings.rs"));
