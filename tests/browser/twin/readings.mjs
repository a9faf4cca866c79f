export async function testReadings() {}
