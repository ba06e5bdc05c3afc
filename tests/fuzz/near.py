"""Near misses of streams and files from a seed: packets, slcan lines, logs, SPI transactions."""

from random import Random

from bus.protocol import COMMAND_BASE, Device, Opcode
from bus.protocol.serial import SAMPLES, SYNC, pack_packet
from tests.fuzz.inputs import data

COMMAND = b"t%03X8%02X%02X000000000000\r"
"""A COMMAND on a debug port: identifier, device type, opcode."""
_PACKETS = [
    pack_packet(Device.FOCUS, 7, 1_000_000, [(1, 2, 3)] * SAMPLES),
    pack_packet(Device.POSITION_RA, 255, (1 << 32) - 1, [((1 << 29) - 1,)] * SAMPLES),
    pack_packet(Device.POSITION_DEC, 0, 0, [(0xAA55AA55,)] * SAMPLES),
    pack_packet(Device.AXIS_RA, 1, 5, [(1, 2, 3, 4, 5, 6, 7, 8, 9)] * SAMPLES),
]
_SLCAN = (
    b"O\r", b"C\r", b"V\r", b"S6\r", b"Z1\r", b"t", b"T", b"r", b"\r", b"\a", b"\n", b"+", b"_", b" ", b"x",
    b"t0D10\r", b"t0d1200ff\r", b"t+D10\r", b"t0_110\r", b"t0D1212 3\r", b"tFFF0\r",
    b"t0D19" + b"00" * 9 + b"\r",
)  # fmt: skip
_CANDUMP = (
    "(", ")", "#", "##1", " ", "\t", "R", "R9", "R0", "r", "0", "F", "FFF", "20000004", "3FFFFFFF", "-", "+",
    "_", ".", "00", "9" * 20, "9" * 5000, "\r", "\n", "\0", "\xb2", " R", "e", "(0.1) can0 211#00\n",
)  # fmt: skip
AXIS_PIECES = (
    ",", ",,", ";", '"', '""', "#", "# axis: dec\n", "\n", "\n\n", "\r", "\t", " ", "-", "+", "_", ".", "e",
    "e300", "1e999", "9" * 400, "1_0", "nan", "NaN", "inf", "null", "None", "0x10", "\u0661", "\u2028",
    "\x85", "\x0b", "\0", "\ufeff", "true", "12:00", "2026-01-01", "t", "aux", "# adc_A_per_count: 1e12\n",
    "# sample_period_s: 1e-300\n", "# counter_torque: 1_0\n", ":", "# ", "\n" * 450,
)  # fmt: skip
GUIDE_PIECES = (
    ",", '"', "\n", "-", ".", "1.2.3", "..", "9" * 400, "1e999", "nan", "inf", "_", "AO", "DROP", "Mount",
    "INFO: ", "INFO: DITHER by 1.0, .\n",
    "INFO: SET LOCK POS, lock position = 1.2.3, .\n", "Guiding Begins at ",
    "Guiding Begins at 2017-02-31 25:61:61\n", "Guiding Ends\n", "Calibration Begins\n", "Pixel scale = ",
    "0,0", "-1", "\r", "\0", "\x85", "\u2028", "Frame,Time,mount,", "RADuration", " ", "\xff",
    "lock pos = +-1, 2",
)  # fmt: skip


def packets(random: Random) -> bytes:
    """Up to three packets; now and then torn, with a byte wrong, or with noise and false syncs between."""
    stream = b""
    for _ in range(random.randrange(4)):
        each = bytearray(random.choice(_PACKETS[: random.choice((3, 3, 3, 4))]))
        kind = random.random()
        if kind < 0.3:
            each[random.randrange(len(each))] ^= 1 << random.randrange(8)
        elif kind < 0.5:
            del each[random.randrange(len(each)) :]
        stream += random.choice((b"", SYNC, SYNC[:1], data(random, 12))) + each
    return stream + random.choice((b"", SYNC, SYNC[:1], SYNC + bytes([Device.FOCUS]), data(random, 12)))


def slcan_line(random: Random, device: int) -> bytes:
    """A frame's line without its end, mostly one character wrong."""
    length = random.randrange(9)
    line = bytearray(b"t%03X%d" % (COMMAND_BASE + device, length) + data(random, 99)[:length].hex().encode())
    for _ in range(random.choice((0, 1, 1, 2))):
        at = random.randrange(len(line))
        line[at : at + random.randrange(2)] = random.choice(
            (b"+", b"_", b" ", b"-", b"g", b"F", b"9", b"\xff", b"a")
        )
    return bytes(line)


def slcan(random: Random, device: int) -> bytes:
    """Lines for a debug port; now and then one that never ends."""
    said = b""
    for _ in range(random.randrange(1, 5)):
        kind = random.random()
        if kind < 0.4:
            said += random.choice(_SLCAN)
        elif kind < 0.6:
            said += COMMAND % (COMMAND_BASE + device, device, random.choice([*Opcode, 0, 0x7E]))
        elif kind < 0.98:
            said += slcan_line(random, device) + b"\r"
        else:
            said += random.choice((b"x", b"O", b"S")) * random.choice((200, 300, 600))
    return said


def mangled(random: Random, text: str, pieces: tuple[str, ...]) -> bytes:
    """`text` with pieces put in, or with parts of it lost, doubled or changed; now and then no UTF-8."""
    for _ in range(random.choice((0, 1, 1, 1, 2, 5))):
        at = random.randrange(len(text) + 1)
        kind = random.random()
        if kind < 0.6:
            text = text[:at] + random.choice(pieces) + text[at + random.randrange(3) :]
        elif kind < 0.8:
            text = text[:at] + text[at + random.randrange(40) :]
        elif kind < 0.9:
            text = text[:at] + text[max(0, at - random.randrange(120)) :]
        else:
            text = text[:at]
    said = text.encode("utf-8", "surrogatepass")
    return (
        said if random.random() < 0.95 else said[: len(said) // 2] + data(random, 9) + said[len(said) // 2 :]
    )


def candump(random: Random) -> bytes:
    """A log of a few frames of all kinds, mangled."""
    lines = ""
    for _ in range(random.randrange(1, 6)):
        body = random.choice((data(random, 8).hex().upper(), "R", f"R{random.randrange(9)}"))
        name = random.choice(("211", "000", "7FF", "00000001", "1FFFFFFF", "20000004"))
        lines += (
            f"({random.choice((0, 9, 1_700_000_000))}.{random.randrange(10**6):06d}) can0 {name}#{body}\n"
        )
    return mangled(random, lines, _CANDUMP) if random.random() < 0.7 else lines.encode()


def spi(random: Random, instructions: list[int]) -> bytes:
    """A transaction: an instruction that exists with noise behind it, a bus being set up, or noise."""
    kind = random.random()
    if kind < 0.1:
        return random.choice((b"\x02\x0f\x00", b"\x05\x0f\xe0\x00", b"\x02\x0f\x80", b"\x81", b"\x87"))
    return bytes([random.choice(instructions)] if kind < 0.7 else []) + data(random, 17)
