"""Hostile bytes, text and frames from a seed: mostly near misses, as plain noise is refused at once."""

from pathlib import Path
from random import Random

from bus.can import Frame
from bus.protocol import COMMAND_BASE, Device, Opcode

MEMORY = "/dev/shm" if Path("/dev/shm").is_dir() else None
"""Where files of a few lines are written by the million: a disk would take most of the time."""
_IDENTIFIERS = [base + device for device in Device for base in (0x080, 0x100, 0x200, 0x300, 0x700)]
_EDGES = (0, 1, 0x7F, 0x80, 0xF3, 0xF7, 0xFF)
_OBJECTS = (
    0x1000, 0x1001, 0x1003, 0x1005, 0x1008, 0x1010, 0x1011, 0x1014, 0x1016, 0x1017, 0x1018, 0x1200, 0x1400,
    0x1600, 0x1800, 0x1801, 0x1803, 0x1A00, 0x1A01, 0x1A03, 0x2000, 0x2101, 0x2102, 0x5000,
)  # fmt: skip
_REQUESTS = (0x23, 0x2F, 0x40, 0x60, 0x80, 0xA0, 0xA1, 0xA2, 0xA3, 0xA4, 0xC0)
"""SDO: downloads, uploads, segments, aborts, blocks (CiA 301, 7.2.4.3)."""
_SETTINGS = (
    b"save", b"load", bytes(4), b"\x81\x03\x00\x80", b"\x81\x03\x00\x00", b"\x01\x00\x00\x00",
    b"\xff\x00\x00\x00", b"\x20\x00\x02\x21", b"\x40\x03\x00\x20", b"\x08\x00\x01\x10", b"\x64\x00\x7f\x00",
)  # fmt: skip
"""Stored, moved, by SYNC, mapped objects, a master watched."""
_WORDS = (
    "speed", "pause", "resume", "power", "status", "stop", "token", "help", "FOCUS", "AXIS_RA", "on", "off",
    "snapshot", "../x", "/tmp/x",
    "nan", "inf", "-1", "1e400", "0", "5", "\0", "\u2028", "\ud7ff", "x" * 1200, " ", "\t",
)  # fmt: skip
_STEPS = (
    "join", "listen", "send", "step", "1", "2", "3", "-1", "a", "b", "5ms", "5", "ms", "0 s", "1e400 s",
    "inf s", "nan s", "-1 ms", "9999999999 h", "0.1 us", "1e-400 s", "5 kg", "011#1105", "7FF#", "7FF#R",
    "1FFFFFFF#00", "3FFFFFFF#00", "091#1110010000000000", "091##1", "#", "91#1", "011#" + "0" * 18,
)  # fmt: skip
_YAML = (
    "name: x", "start_utc: 2026-02-10T14:00:00Z", "steps:", "  - power_on: {}", "  - wait: {for: 1 s}",
    "  - goto: {target: Capella}", "speed: 1", "description: &a [x, y]", "b: *a", "plant: low-preload",
    "- ", ": ", "seed: 1",
    "{", "}", "[", "]", "&a ", "*a", "!!int ", "!!timestamp ", "!!python/object:x ", "|", ">", "'", '"',
    "\\0", "\0", "\t", ".inf", ".nan", "1e400", "9" * 50, "? ", "<<: ", "%YAML 9.9", "---", "...", "\ufeff",
    "\x85",
    "faults: [{node_off: {node: AXIS_RA}, at: 1 s}]", "network: {bitrate: 500 kbit/s}", "logs: {status: 1 s}",
    "expect: [{overruns: {at_most: 0}}]", "site: {height: 5 m}", "mount: {declination_low: -10 deg}",
)  # fmt: skip


def data(random: Random, most: int) -> bytes:
    """Up to `most` bytes, edge values more often than others."""
    length = random.choice((0, 1, most - 1, most, random.randrange(most + 1)))
    return bytes(
        random.choice(_EDGES) if random.random() < 0.5 else random.randrange(256) for _ in range(length)
    )


def frame(random: Random) -> Frame:
    """A frame: a peer's identifier with wrong bytes, a command with odd arguments, or anything."""
    kind = random.random()
    if kind < 0.4:
        identifier = random.choice(_IDENTIFIERS)
        body = data(random, 8)
        if body and random.random() < 0.7:
            body = bytes([identifier & 0x7F]) + body[1:]
        return Frame(identifier, body, remote=random.random() < 0.05)
    if kind < 0.8:
        device = random.choice(list(Device))
        opcode = random.choice([*Opcode, 0, 0x7E, 0xFE])
        return Frame(COMMAND_BASE + device, bytes([device, opcode]) + data(random, 6).ljust(6, b"\0"))
    extended = random.random() < 0.5
    identifier = random.randrange(1 << (29 if extended else 11))
    return Frame(identifier, data(random, 8), extended, random.random() < 0.2)


def canopen(random: Random, nodes: list[int]) -> Frame:
    """An NMT command or an SDO request to one of `nodes`, often of a wrong length, or any frame."""
    kind = random.random()
    node = random.choice(nodes)
    if kind < 0.3:
        command = random.choice((0x01, 0x02, 0x80, 0x81, 0x82, 0x50, 0x60, random.randrange(256)))
        said = bytes([command, random.choice((0, node, random.randrange(256)))])
        return Frame(
            0x000, said[: random.choice((0, 1, 2, 2, 2))] + data(random, 6) * (random.random() < 0.1)
        )
    if kind < 0.9:
        index = random.choice(_OBJECTS)
        head = bytes([random.choice((random.randrange(256), *_REQUESTS))]) + index.to_bytes(2, "little")
        value = random.choice((data(random, 4).ljust(4, b"\0"), *_SETTINGS))
        said = head + bytes([random.randrange(6)]) + value
        return Frame(0x600 + node, said if random.random() < 0.8 else said[: random.randrange(8)])
    if kind < 0.95:  # SYNC, a master's heartbeat, a PDO where one may have been moved
        return Frame(random.choice((0x080, 0x77F, 0x700 + node, 0x381, 0x401)), data(random, 8))
    return frame(random)


def report(random: Random) -> bytes:
    """A HID report's worth of slots, sometimes of a wrong length."""
    if random.random() < 0.1:
        return data(random, 130)
    slots = [frame(random).data.ljust(8, b"\0") for _ in range(8)]
    return b"".join(slots)


def line(random: Random) -> bytes:
    """A line for the control plane. `stop` would only end the test."""
    words = [random.choice(_WORDS) for _ in range(random.randrange(5))]
    if words[:1] == ["stop"]:
        words[0] = "status"
    text = " ".join(words).encode("utf-8", "surrogatepass")
    return (data(random, 40).replace(b"stop", b"") if random.random() < 0.2 else text) + b"\n"


def stepped(random: Random) -> bytes:
    """A line for `--clock steps`: one that can be meant, its words in disorder, or another of the plane."""
    if random.random() < 0.2:
        return line(random).rstrip(b"\n")
    if random.random() < 0.4:
        words = random.choice(("join 1", "join 2 a", "join 3 b", "listen", "send 011#1105", "step 2ms"))
    else:
        words = " ".join(random.choice(_STEPS) for _ in range(random.randrange(1, 4)))
    return words.encode()


def datagram(random: Random) -> bytes:
    """Something on the multicast group: msgpack of a message with fields that are wrong, or noise."""
    import msgpack

    if random.random() < 0.3:
        return data(random, 80)
    odd = (None, -1, 1.5, "x", b"", [], {}, True, 1 << 40, 0x7FF, bytes(8), bytes(64))
    fields: dict[str, object] = {
        "timestamp": 0.0, "arbitration_id": 0x091, "is_extended_id": False, "is_remote_frame": False,
        "is_error_frame": False, "channel": None, "dlc": 8, "data": bytes(8), "is_fd": False,
        "bitrate_switch": False, "error_state_indicator": False,
    }  # fmt: skip
    for key in random.sample(sorted(fields), random.randrange(4)):
        fields[key] = random.choice(odd)
    if random.random() < 0.2:
        fields["nonsense"] = random.choice(odd)
    packed: bytes = msgpack.packb(fields, use_bin_type=True)
    return packed[: random.randrange(len(packed))] if random.random() < 0.2 else packed


def scenario(random: Random) -> str:
    """A good scenario with some of its lines lost, doubled, or replaced by pieces and signs of YAML."""
    lines = [
        "name: x",
        "start_utc: 2026-02-10T14:00:00Z",
        "steps:",
        "  - power_on: {}",
        "  - wait: {for: 1 s}",
    ]
    for _ in range(random.choice((0, 1, 1, 2, 3, 8))):
        at = random.randrange(len(lines) + 1)
        kind = random.random()
        if kind < 0.5:
            lines.insert(at, random.choice(_YAML))
        elif kind < 0.8 and lines:
            at = random.randrange(len(lines))
            cut = random.randrange(len(lines[at]) + 1)
            lines[at] = lines[at][:cut] + random.choice(_YAML) + lines[at][cut:]
        elif lines:
            del lines[random.randrange(len(lines))]
    return "\n".join(lines) + "\n"


_ARGUMENTS = (
    "12:34:56", "23:59.9", "24:00:00", "+45*30:00", "-91*00:00", "+99\xdf59", "02/10/26", "5.5", "-0",
    "9" * 30,
    "", " ", "+", ":", "1e5", "nan", "\xdf", "00:00:00", "079*27", "n2000", "s99999", "ns", "\0",
)  # fmt: skip


def lx200(random: Random, letters: list[str]) -> bytes:
    """One to three commands, now and then torn or with rubbish in them."""
    said = b""
    for _ in range(random.randrange(1, 4)):
        text = random.choice(letters) if random.random() < 0.8 else random.choice(_ARGUMENTS)
        text += random.choice(_ARGUMENTS) if random.random() < 0.6 else ""
        command = b":" + text.encode("latin-1", "replace") + b"#"
        if random.random() < 0.1:
            command = command[: random.randrange(len(command))] + data(random, 6)
        said += command
    return said


_NAMES = (
    "RightAscension", "Declination", "Azimuth", "Altitude", "Axis", "Rate", "Direction", "Duration",
    "Connected", "Tracking", "TargetRightAscension", "TargetDeclination", "Position", "Action", "Parameters",
    "TrackingRate", "UTCDate", "SiteLatitude", "ClientID", "ClientTransactionID", "clientid", "",
)  # fmt: skip
_VALUES = (
    "0", "1", "-1", "5.5", "12", "45", "1e400", "nan", "inf", "True", "false", "", "9" * 400, "0x10",
    "PowerOn",     "2026-02-10T14:00:00Z", "%00", "%ff%fe", "+", "a&b", "null", "800", "-800", "4294967296",
)  # fmt: skip


def alpaca(random: Random, members: list[tuple[str, str]]) -> tuple[str, str, bytes, bytes]:
    """Method, path, query and body of a request."""
    kind, name = random.choice(members)
    if random.random() < 0.1:
        kind, name = random.choice((("dome", "Azimuth"), (kind, name.swapcase()), (kind, "\u2028"), ("", "")))
    number = "0" if random.random() < 0.95 else random.choice(("1", "-1", "x", "9" * 30))
    pairs = [f"{random.choice(_NAMES)}={random.choice(_VALUES)}" for _ in range(random.randrange(6))]
    given = "&".join(pairs).encode()
    if random.random() < 0.1:
        given = data(random, 60)
    method = random.choice(("GET", "PUT", "PUT", "POST"))
    path = f"/api/v1/{kind}/{number}/{name.lower() if random.random() < 0.97 else name}"
    return (method, path, given, b"") if method == "GET" else (method, path, b"", given)
