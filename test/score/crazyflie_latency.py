"""
How late the bridge is, and what it costs: `python test/score/crazyflie_latency.py`.

From the drone's stamp to the message in another process, over loopback, UDP and DDS; the emulated
drone looks at its clock every 2 ms, which is in it. In the built workspace (tools/workspace.sh).
"""

import os
from pathlib import Path
import time

import add_paths  # noqa: F401
from domain import free_domain
from lta_emulation.crazyflie.body import BenchBody
from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.server import CrazyflieServer
from lta_graph.ros.stamps import from_stamp
import numpy as np
from peer import Peer, start

COUNT = 1000


def processor(pid):
    """Return the processor time of a process. [s]"""
    fields = Path(f'/proc/{pid}/stat').read_text().rpartition(')')[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')


def main():
    with (
        free_domain() as domain,
        CrazyflieServer(Firmware(BenchBody())) as server,
        Peer(domain) as peer,
    ):
        node, late = (
            start(
                'lta_bridge.nodes.crazyflie_bridge',
                '-p',
                f'uri:={server.uri}',
                '-p',
                'blind:=true',
                '-p',
                'allow_other_commanders:=true',
            ),
            [],
        )

        def on_imu(message):
            now = peer.node.get_clock().now().nanoseconds
            late.append(1e-6 * (now - from_stamp(message.header.stamp)))

        peer.hear('imu', on_imu)
        peer.until(lambda: len(late) > 100)
        late.clear()
        used, begun = processor(node.pid), time.monotonic()
        peer.until(lambda: len(late) > COUNT)
        share = (processor(node.pid) - used) / (time.monotonic() - begun)
        node.send_signal(2)
        node.communicate(timeout=20)
    half, most = np.percentile(late, [50, 99])
    print(f'median {half:.1f} ms, 99 % {most:.1f} ms, {100 * share:.0f} % of a core')  # noqa: T201


if __name__ == '__main__':
    main()
