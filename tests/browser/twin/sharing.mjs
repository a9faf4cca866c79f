export async function testSharing(run, server) { return server; }
