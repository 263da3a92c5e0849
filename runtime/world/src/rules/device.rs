//! What every device does when it is toggled, as a table.

use cohabit_cdf::Color;

use crate::works::Work;

/// How a device answers a press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Toggling {
    /// On if off, off if on.
    Flips,
    /// The same, and the tap with it: water runs, or is gone.
    Runs,
    /// The same, and what it works with it.
    FlipsBoth,
    /// The same; what it works is a portal.
    Portal,
    /// On for a moment.
    Moment,
    /// On for a moment, if something is in it and its door, if it has one, is shut.
    MomentWithContents,
    /// On for a moment, if something is in it and a fluid is there.
    MomentWithFluid,
    /// On for a moment, with a cartridge in it and room for what it prints.
    Prints,
    /// On for a moment, if something is in what it works.
    MomentAt,
    /// On for a moment, if something is in this slot of what it works.
    Vends(u16),
    /// Fires what it works for a moment, at what that aims at; off, if it runs.
    Fires {
        /// Which classes must all be in the machine.
        parts: &'static [&'static str],
    },
    /// Cuts or feeds the circuit of the box it is in.
    Breaker,
    /// Opens or closes all doors of the reception.
    Doors,
    /// Live while it is on.
    Sparks,
    /// Never by itself: this is what works it.
    WorkedBy(&'static str),
}

impl Toggling {
    /// Whether a press is answered whatever the class affords.
    pub const fn answers_always(self) -> bool {
        matches!(self, Self::Doors | Self::WorkedBy(_))
    }
}

/// One kind of device.
#[derive(Clone, Copy, Debug)]
pub(super) struct Device {
    pub class: &'static str,
    pub toggling: Toggling,
    pub work: Work,
    /// The classes that it works, where a layout does not say which object.
    pub works: &'static [&'static str],
}

const fn device(class: &'static str, toggling: Toggling, work: Work) -> Device {
    Device { class, toggling, work, works: &[] }
}

const fn control(class: &'static str, toggling: Toggling, work: Work, works: &'static [&'static str]) -> Device {
    Device { class, toggling, work, works }
}

const LASER_PARTS: &[&str] = &["Laser_Tip", "Laser_CircuitBoard", "Laser_ControlPanel"];
const RED_SHELVES: &[&str] = &["AP_Prop_Shelf_Wall_Laser"];
const BLUE_SHELVES: &[&str] = &["AP_Prop_Shelf_Wall_04", "AP_Prop_Shelf_Wall_FreezeRay"];
const STATION: &[&str] = &["ColorChangerStation"];
const VENDING: &[&str] = &["VendingMachine_01"];

/// All devices that do more than flip.
pub(super) const DEVICES: &[Device] = &[
    device("KitchenCounterSink_01", Toggling::Runs, Work::Nothing),
    device("FireAlarm_01", Toggling::Moment, Work::Nothing),
    device("Microwave_01", Toggling::Moment, Work::Heat),
    device("Toaster_02", Toggling::Moment, Work::Toast),
    device("CoffeeUnMaker_01", Toggling::Moment, Work::Unbrew),
    device("YesterdayMachine_01", Toggling::MomentWithContents, Work::Yesterday),
    device("CoffeeMaker_01", Toggling::MomentWithFluid, Work::Brew),
    device("EAC_Machine", Toggling::MomentWithContents, Work::Carrot),
    device("Printer_3D", Toggling::Prints, Work::Print),
    control("ColorChanger_Button_Red", Toggling::MomentAt, Work::Paint(Color::Red), STATION),
    control("ColorChanger_Button_Green", Toggling::MomentAt, Work::Paint(Color::Green), STATION),
    control("ColorChanger_Button_Blue", Toggling::MomentAt, Work::Paint(Color::Blue), STATION),
    control("VendingMachine_01_B4_Button", Toggling::Vends(0), Work::Vend(0), VENDING),
    control("VendingMachine_01_E5_Button", Toggling::Vends(1), Work::Vend(1), VENDING),
    control("VendingMachine_01_E7_Button", Toggling::Vends(2), Work::Vend(2), VENDING),
    control("VendingMachine_01_M8_Button", Toggling::Vends(3), Work::Vend(3), VENDING),
    control("V_Monitor_Laser", Toggling::Fires { parts: LASER_PARTS }, Work::Heat, &["Laser"]),
    control("V_Monitor_FreezeRay", Toggling::Fires { parts: &[] }, Work::Chill, &["FreezeRay"]),
    control("V_Monitor_Embiggenator", Toggling::MomentAt, Work::Embiggen, &["Embiggenator"]),
    control("V_Monitor_Gravity", Toggling::FlipsBoth, Work::Nothing, &["GravityPad"]),
    control("V_Monitor_Portal", Toggling::Portal, Work::Nothing, &["PortalGenerator"]),
    control("Laser", Toggling::WorkedBy("the red computer"), Work::Nothing, RED_SHELVES),
    control("FreezeRay", Toggling::WorkedBy("the blue computer"), Work::Nothing, BLUE_SHELVES),
    device("GravityPad", Toggling::WorkedBy("the green computer"), Work::Nothing),
    device("Embiggenator", Toggling::WorkedBy("the pink computer"), Work::Nothing),
    device("PortalGenerator", Toggling::WorkedBy("the black computer"), Work::Nothing),
    device("ColorChangerStation", Toggling::WorkedBy("one of the coloured buttons"), Work::Nothing),
    device("FuseBox_01", Toggling::WorkedBy("its lever"), Work::Nothing),
    device("FuseBox_02", Toggling::WorkedBy("its lever"), Work::Nothing),
    device("FuseBox_01_Lever", Toggling::Breaker, Work::Nothing),
    device("Security_Button", Toggling::Doors, Work::Nothing),
    device("Broken_Cord_01", Toggling::Sparks, Work::Nothing),
    device("CableFrayed_01", Toggling::Sparks, Work::Nothing),
];

/// The device of a class; what is not in the table flips.
pub(super) fn of_class(class: &str) -> Device {
    DEVICES.iter().find(|device| device.class == class).copied().unwrap_or(Device {
        class: "",
        toggling: Toggling::Flips,
        work: Work::Nothing,
        works: &[],
    })
}
