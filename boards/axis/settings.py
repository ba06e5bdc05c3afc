"""What the axis board is programmed with, as numbers in the order that `axis.c` reads them."""

from boards.axis.config import AxisConfig, AxisPeers
from boards.axis.pi import GAIN_SHIFT
from bus.protocol.scales import TICKS_PER_S


def settings(config: AxisConfig, peers: AxisPeers) -> tuple[int, ...]:
    """Parameters 1 to 11 first, then what no command changes; gains in Q12, the position loop's in Q16."""
    gains = (config.kp, config.ki, config.kp_pointing, config.ki_pointing, config.ki_creep)
    gusts = (config.kp_gust, config.ki_gust)
    kp, ki, *pointing = (round(gain * (1 << GAIN_SHIFT)) for gain in (*gains, *gusts))
    parameters = (config.counter_split, kp, ki, config.low, config.high, config.acceleration, *config.classes)
    return (
        *parameters,
        *pointing,
        config.split_fade_counts,
        config.pwm_steps,
        round(config.position_gain / TICKS_PER_S * 65536),
        config.correction,
        config.creep_rate,
        config.lag_steps,
        config.settle_steps,
        config.frame_ns,
        *(peers.position, peers.motor_a, peers.motor_b, peers.auxiliary or 0),
    )
