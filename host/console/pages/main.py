"""Main console (H2): power, health, slewing, tracking, hand paddle, targets, limits, parameters, status."""

from nicegui import ui
from nicegui.events import KeyEventArguments

from bus.protocol import AxisParameter, Device, Health, SpeedClass
from host.console.figures import number, pointing
from host.console.pages.target import target
from host.console.plots import plots
from host.console.shell import Shell, box, button, log_of, seldom, stale, table
from host.telescope import BoardState

SPEEDS = {
    speed.name.lower(): speed
    for speed in (SpeedClass.SLEW, SpeedClass.SET, SpeedClass.GUIDE, SpeedClass.FINE)
}
SHOWN_EVENTS = 14
ARROWS = {"ArrowUp": "n", "ArrowDown": "s", "ArrowLeft": "e", "ArrowRight": "w"}


def main(shell: Shell) -> None:
    """The page."""
    with shell.page("/", "Main console"), ui.element("div").classes("boxes"):
        _place(shell)
        _motors(shell)
        paddle(shell)
        target(shell)
        _night(shell)
        _boards(shell)
        plots(shell)
        _parameters(shell)


def _place(shell: Shell) -> None:
    with box("Where it points (apparent, of date)"), ui.element("div").classes("pair"):
        labels = {}
        for name, size in (("RA", "big"), ("Dec", "big"), ("HA", "mid"), ("Alt", "mid"), ("Az", "mid")):
            ui.label(name).classes("small")
            labels[name] = ui.label("–").classes(size)
        ui.label("rates").classes("small")
        rates = ui.label("–").classes("mid")
        ui.label("errors").classes("small")
        errors = ui.label("–").classes("mid")

    @shell.each
    def refresh() -> None:
        now, here = shell.desk.now, pointing(shell.telescope)
        for name, text in zip(labels, here[:5], strict=True):
            labels[name].set_text(text)
        rates.set_text(f"{now.ra.rate_arcsec_s:+.1f}″/s  {now.dec.rate_arcsec_s:+.1f}″/s")
        scale, unit = (3600, "°") if now.slewing else (1, "″")
        found = [number(each / scale, "+.2f", unit) for each in now.errors_arcsec or ()]
        errors.set_text("  ".join(found) or "–")
        old = now.stale
        for name, label in labels.items():
            mine = (Device.POSITION_DEC,) if name == "Dec" else (Device.POSITION_RA, Device.POSITION_DEC)
            stale(label, not old.isdisjoint(mine[:1] if name in ("RA", "HA", "Dec") else mine))
        stale(errors, not old.isdisjoint((Device.POSITION_RA, Device.POSITION_DEC)))
        stale(rates, not old.isdisjoint((Device.AXIS_RA, Device.AXIS_DEC)))


def _motors(shell: Shell) -> None:
    with box("Motors and tracking"):
        with ui.row():
            for text, act in (
                ("Power on", lambda t: t.drive.power_on()),
                ("Power off", lambda t: t.drive.power_off()),
                ("Park", lambda t: t.drive.park()),
                ("Unpark", lambda t: t.drive.power_on()),
            ):
                shell.control(button(text, on_click=shell.doing(act)))
        with ui.row():
            for text, act in (
                ("Track", lambda t: t.drive.track(True)),
                ("Stop tracking", lambda t: t.drive.track(False)),
                ("Abort slew", lambda t: t.drive.abort()),
                ("Health check", lambda t: t.boards.check()),
            ):
                shell.control(button(text, on_click=shell.doing(act)))
        supply = ui.label().classes("mid")
        shell.each(
            lambda: supply.set_text(
                "motors on, tracking"
                if shell.desk.now.powered and shell.desk.now.tracking
                else "motors on"
                if shell.desk.now.powered
                else "motors off"
            )
        )


def paddle(shell: Shell) -> None:
    """Keys to hold, and the arrow keys."""
    held: set[str] = set()
    with box("Hand paddle (also the arrow keys)"):
        speed = shell.control(
            ui.radio(list(SPEEDS), value="guide").props('inline aria-label="Speed of the paddle"')
        )

        async def press(direction: str) -> None:
            if direction not in held:
                held.add(direction)
                chosen = SPEEDS[speed.value]
                await shell.attempt(shell.desk.do(lambda t: t.paddle.press(direction, chosen)))

        async def release(direction: str) -> None:
            if direction in held:
                held.discard(direction)
                axis = "dec" if direction in "ns" else "ra"
                await shell.attempt(shell.desk.do(lambda t: t.paddle.release(axis), always=True))

        with ui.element("div").classes("paddle"):
            for cell in ("", "n", "", "e", "", "w", "", "s", ""):
                if not cell:
                    ui.element("span")
                    continue
                name = {"n": "N ↑", "s": "S ↓", "e": "E ←", "w": "W →"}[cell]
                key = shell.control(button(name).props(f'aria-label="Move {name}"'))
                for event in ("mousedown", "touchstart"):
                    key.on(event, lambda d=cell: press(d))
                for event in ("mouseup", "mouseleave", "touchend", "touchcancel"):
                    key.on(event, lambda d=cell: release(d))

    def arrow(event: KeyEventArguments) -> None:
        direction = ARROWS.get(str(event.key))
        if direction and not event.action.repeat:
            ui.timer(0, lambda: (press if event.action.keydown else release)(direction), once=True)

    def gone() -> None:
        if held:  # a browser that vanishes lets go of its keys
            shell.telescope.call(lambda t: t.paddle.release())

    shell.key(arrow)
    ui.context.client.on_disconnect(gone)


def _boards(shell: Shell) -> None:
    with box("Boards"):
        fill = table(("board", "state", "health", "TEC", "over"))

    def refresh() -> None:
        fill([_board_row(board) for board in shell.desk.now.boards])

    shell.each(seldom(refresh))


def _board_row(board: BoardState) -> tuple[str, ...]:
    health = "not asked" if board.health is None else (flags(board.health) or "healthy")
    state = board.state.name.lower() if board.alive and board.state else "SILENT"
    return board.device.name, state, health, str(board.tec), str(board.overruns)


def flags(health: Health) -> str:
    """Names of the bits that are set; empty when all is well."""
    return ", ".join(bit.name.lower().replace("_", " ") for bit in Health if bit in health and bit.name)


def _parameters(shell: Shell) -> None:
    devices = {"RA axis": Device.AXIS_RA, "Dec axis": Device.AXIS_DEC}
    kinds = {parameter.name.lower(): int(parameter) for parameter in AxisParameter}
    with box("Parameters"):
        with ui.row().classes("w-full"):
            board = shell.field(ui.select(list(devices), value="RA axis", label="Board"))
            kind = shell.field(ui.select(list(kinds), value="kp_q12", label="Parameter"), wide=True)
            value = shell.field(ui.number("Value", value=0, format="%d"))

        async def read() -> None:
            device, which = devices[board.value], kinds[kind.value]
            got = await shell.attempt(shell.desk.run(lambda t: t.boards.get(device, which)))
            if got is not None:
                value.set_value(got)

        async def write() -> None:
            device, which, wanted = devices[board.value], kinds[kind.value], int(value.value or 0)
            got = await shell.attempt(shell.desk.run(lambda t: t.boards.set(device, which, wanted)))
            if got is not None:
                value.set_value(got)
                shell.say(f"{board.value} {kind.value} is {got}")

        with ui.row():
            shell.control(button("Read", on_click=read))
            shell.control(button("Write", on_click=write))


def _night(shell: Shell) -> None:
    with box("Night log, UTC"):
        log_of(shell, "Night log", lambda: list(shell.live.events.kept.copy())[-SHOWN_EVENTS:])
