!> Density and viscosity of the fluid in fractures as functions of its pressure.
!!
!! Both are piecewise: between the pressures of adjacent points the logarithms of both are linear.
!! An exponential law is one such interval, a table has one for each two of its pressures; outside
!! of them both are constant. With
!!   r = rho/rho_0,   rho_0 and mu_0 at the reference pressure p_0
!! a fracture contains the mass rho_0 a r per length, and conducts, by the cubic law,
!!   rho_0 a^3/12 (r/mu) dp/ds = rho_0 a^3/(12 mu_0) dm/ds,
!!   m(p) = integral from p_0 of mu_0 r/mu dp,
!! so that between two places of one aperture the flow follows exactly from the difference of the
!! potential m (Kirchhoff's transformation), which increases with p for every law: without one m =
!! p.
!!
!! Also the storage of the rock, and its undrained pressure under a load.
module scene_fluid_law
   use base_kinds, only: ik, rk
   use scene_types, only: fluid_t, material_t
   implicit none(type, external)
   private

   public :: bulk_modulus, fluid_law_t, has_law, least_compressibility, new_fluid_law, skempton
   public :: storage, strained_storage, viscosity_ratio

   !> Range of an exponential law, as a logarithm of its change: values remain finite in every
   !! iteration [-].
   real(rk), parameter :: largest_exponent = 50.0_rk

   !> Density and viscosity in the intervals 0 to n, of which interval k begins at pressure k.
   type :: fluid_law_t
      real(rk), allocatable :: pressure(:)  !< (n) increasing [Pa]
      real(rk), allocatable :: compressibility(:)  !< (0:n) d ln rho/dp in each interval [1/Pa]
      real(rk), allocatable :: thickening(:)  !< (0:n) d ln mu/dp in each interval [1/Pa]
      real(rk), allocatable :: density(:)  !< (n) r at the pressures [-]
      real(rk), allocatable :: mobility(:)  !< (n) mu_0 r/mu at the pressures [-]
      real(rk), allocatable :: potential(:)  !< (n) m at the pressures [Pa]
      integer(ik) :: reference = 1  !< index of the reference pressure
      logical :: changes_density = .false.  !< .false.: r = 1
      logical :: is_table = .false.  !< the law is known only between its pressures
   contains
      procedure :: interval
      procedure :: density_at
      procedure :: potential_at
      procedure :: thickness_at
      procedure :: thickness_slope
   end type fluid_law_t

contains

   !> Viscosity or density of the fluid in fractures depends on pressure.
   pure logical function has_law(fluid)
      type(fluid_t), intent(in) :: fluid

      has_law = fluid%viscosity_law /= "constant" .or. fluid%density_law /= "linear"
   end function has_law

   !> The law of the fluid of a scene.
   pure function new_fluid_law(fluid) result(law)
      type(fluid_t), intent(in) :: fluid
      type(fluid_law_t) :: law
      real(rk) :: exponent, reference
      real(rk), allocatable :: density(:), thickness(:)
      integer(ik) :: k, n

      reference = fluid%reference_pressure
      law%changes_density = fluid%density_law /= "linear"
      law%is_table = fluid%viscosity_law == "table" .or. fluid%density_law == "table"
      allocate (law%pressure(0))
      if (law%is_table) law%pressure = fluid%table_pressure
      exponent = 0.0_rk
      if (fluid%viscosity_law == "exponential") exponent = abs(fluid%viscosity_exponent)
      if (fluid%density_law == "exponential") exponent = exponent + fluid%compressibility
      if (exponent > 0.0_rk) then
         call insert(reference - largest_exponent/exponent, law%pressure)
         call insert(reference + largest_exponent/exponent, law%pressure)
      end if
      call insert(reference, law%pressure)
      law%reference = count(law%pressure <= reference, kind=ik)
      n = size(law%pressure, kind=ik)
      allocate (law%compressibility(0:n), law%thickening(0:n), source=0.0_rk)
      allocate (density(n), thickness(n), law%potential(n))
      do k = 1, n
         density(k) = log_density(fluid, law%pressure(k))
         thickness(k) = log_viscosity(fluid, law%pressure(k))
      end do
      do k = 1, n - 1
         associate (length => law%pressure(k + 1) - law%pressure(k))
            law%compressibility(k) = (density(k + 1) - density(k))/length
            law%thickening(k) = (thickness(k + 1) - thickness(k))/length
         end associate
      end do
      density = density - density(law%reference)
      thickness = thickness - log(fluid%viscosity)
      law%density = exp(density)
      law%mobility = exp(density - thickness)
      law%potential(law%reference) = 0.0_rk
      do k = law%reference + 1, n
         law%potential(k) = law%potential(k - 1) + rise(law, k - 1, k)
      end do
      do k = law%reference - 1, 1, -1
         law%potential(k) = law%potential(k + 1) + rise(law, k + 1, k)
      end do
   end function new_fluid_law

   !> Increase of the potential from a pressure of the law to an adjacent one [Pa].
   pure real(rk) function rise(law, from, to)
      type(fluid_law_t), intent(in) :: law
      integer(ik), intent(in) :: from, to

      associate (k => min(from, to))
         rise = law%mobility(from)*grown(law%compressibility(k) - law%thickening(k), &
                                         law%pressure(to) - law%pressure(from))
      end associate
   end function rise

   !> Insert a pressure into an increasing list, unless it is in it.
   pure subroutine insert(value, list)
      real(rk), intent(in) :: value  !< [Pa]
      real(rk), allocatable, intent(inout) :: list(:)  !< [Pa]

      if (any(list <= value .and. list >= value)) return
      list = [pack(list, list < value), value, pack(list, list > value)]
   end subroutine insert

   !> ln rho up to a constant [-].
   pure real(rk) function log_density(fluid, pressure) result(density)
      type(fluid_t), intent(in) :: fluid
      real(rk), intent(in) :: pressure  !< [Pa]

      select case (fluid%density_law)
      case ("exponential")
         density = fluid%compressibility*(pressure - fluid%reference_pressure)
      case ("table")
         density = interpolated(fluid%table_pressure, log(fluid%table_density), pressure)
      case default
         density = 0.0_rk
      end select
   end function log_density

   !> ln mu [ln(Pa s)].
   pure real(rk) function log_viscosity(fluid, pressure) result(viscosity)
      type(fluid_t), intent(in) :: fluid
      real(rk), intent(in) :: pressure  !< [Pa]

      select case (fluid%viscosity_law)
      case ("exponential")
         viscosity = log(fluid%viscosity) &
                     + fluid%viscosity_exponent*(pressure - fluid%reference_pressure)
      case ("table")
         viscosity = interpolated(fluid%table_pressure, log(fluid%table_viscosity), pressure)
      case default
         viscosity = log(fluid%viscosity)
      end select
   end function log_viscosity

   !> Viscosity at a temperature over that of the scene [-].
   elemental real(rk) function viscosity_ratio(fluid, temperature) result(ratio)
      type(fluid_t), intent(in) :: fluid
      real(rk), intent(in) :: temperature  !< on the scale of the scene [K]

      ratio = exp(interpolated(fluid%table_temperature, log(fluid%viscosity_at), temperature)) &
              /fluid%viscosity
   end function viscosity_ratio

   !> Value of a table: linear between its places, constant beyond them [unit of y].
   pure real(rk) function interpolated(x, y, at) result(value)
      real(rk), intent(in) :: x(:)  !< increasing pressures [Pa] or temperatures [K]
      real(rk), intent(in) :: y(:)  !< [any unit]
      real(rk), intent(in) :: at  !< [Pa] or [K]
      integer(ik) :: k

      k = count(x <= at, kind=ik)
      if (k == 0) then
         value = y(1)
      else if (k == size(x)) then
         value = y(k)
      else
         value = y(k) + (y(k + 1) - y(k))*((at - x(k))/(x(k + 1) - x(k)))
      end if
   end function interpolated

   !> The integral of exp(rate s) over s from 0 to a length.
   elemental real(rk) function grown(rate, length)
      real(rk), intent(in) :: rate  !< [1/Pa]
      real(rk), intent(in) :: length  !< [Pa]

      grown = length
      ! exp(y) - 1 = 2 exp(y/2) sinh(y/2) loses no digits for small y.
      if (abs(rate) > 0.0_rk) then
         grown = 2.0_rk*exp(0.5_rk*rate*length)*sinh(0.5_rk*rate*length)/rate
      end if
   end function grown

   !> Find the interval of a pressure, and its end towards the reference pressure, from which values
   !! are computed: at the other end they may be larger by decades.
   pure subroutine interval(self, pressure, number, from)
      class(fluid_law_t), intent(in) :: self
      real(rk), intent(in) :: pressure  !< [Pa]
      integer(ik), intent(out) :: number
      integer(ik), intent(out) :: from  !< index of the pressure at that end

      number = count(self%pressure <= pressure, kind=ik)
      from = number
      if (number < self%reference) from = number + 1
   end subroutine interval

   !> Find r and its derivative at a pressure.
   pure subroutine density_at(self, pressure, density, slope)
      class(fluid_law_t), intent(in) :: self
      real(rk), intent(in) :: pressure  !< [Pa]
      real(rk), intent(out) :: density  !< [-]
      real(rk), intent(out) :: slope  !< [1/Pa]
      integer(ik) :: from, k

      call self%interval(pressure, k, from)
      density = self%density(from) &
                *exp(self%compressibility(k)*(pressure - self%pressure(from)))
      slope = self%compressibility(k)*density
   end subroutine density_at

   !> Find m and its derivative mu_0 r/mu at a pressure.
   pure subroutine potential_at(self, pressure, potential, slope)
      class(fluid_law_t), intent(in) :: self
      real(rk), intent(in) :: pressure  !< [Pa]
      real(rk), intent(out) :: potential  !< [Pa]
      real(rk), intent(out) :: slope  !< [-]
      integer(ik) :: from, k

      call self%interval(pressure, k, from)
      associate (length => pressure - self%pressure(from), &
                 rate => self%compressibility(k) - self%thickening(k))
         potential = self%potential(from) + self%mobility(from)*grown(rate, length)
         slope = self%mobility(from)*exp(rate*length)
      end associate
   end subroutine potential_at

   !> mu/(mu_0 r): pressure gradient of a mass flow over that at the reference pressure [-].
   elemental real(rk) function thickness_at(self, pressure) result(thickness)
      class(fluid_law_t), intent(in) :: self
      real(rk), intent(in) :: pressure  !< [Pa]
      real(rk) :: potential, slope

      call self%potential_at(pressure, potential, slope)
      thickness = 1.0_rk/slope
   end function thickness_at

   !> Derivative of mu/(mu_0 r) [1/Pa].
   pure real(rk) function thickness_slope(self, pressure) result(slope)
      class(fluid_law_t), intent(in) :: self
      real(rk), intent(in) :: pressure  !< [Pa]
      integer(ik) :: from, k

      call self%interval(pressure, k, from)
      slope = (self%thickening(k) - self%compressibility(k))*self%thickness_at(pressure)
   end function thickness_slope

   !> Storage S at fixed strain [1/Pa].
   pure real(rk) function storage(material, fluid)
      type(material_t), intent(in) :: material
      type(fluid_t), intent(in) :: fluid

      storage = material%porosity*fluid%compressibility + solid_storage(material)
   end function storage

   !> Storage of rock that is strained in one direction: diffusivity is k/(mu S) [1/Pa].
   pure real(rk) function strained_storage(m, fluid) result(stored)
      type(material_t), intent(in) :: m
      type(fluid_t), intent(in) :: fluid
      real(rk) :: modulus

      modulus = m%young*(1.0_rk - m%poisson)/((1.0_rk + m%poisson)*(1.0_rk - 2.0_rk*m%poisson))
      stored = storage(m, fluid) + m%biot**2/modulus
   end function strained_storage

   !> Part of the solid in the storage [1/Pa].
   pure real(rk) function solid_storage(material)
      type(material_t), intent(in) :: material

      solid_storage = (material%biot - material%porosity)/bulk_modulus(material)
      if (material%storage == "textbook") solid_storage = solid_storage*(1.0_rk - material%biot)
   end function solid_storage

   !> Skempton's coefficient B: undrained pressure over mean compression [-].
   pure real(rk) function skempton(material, fluid)
      type(material_t), intent(in) :: material
      type(fluid_t), intent(in) :: fluid

      skempton = 0.0_rk
      if (material%biot > 0.0_rk) then
         skempton = material%biot/(bulk_modulus(material)*storage(material, fluid) &
                                   + material%biot**2)
      end if
   end function skempton

   !> Compressibility of the fluid at which Skempton's coefficient is 1, if that of an
   !! incompressible fluid is larger [1/Pa].
   pure real(rk) function least_compressibility(material)
      type(material_t), intent(in) :: material

      least_compressibility = (material%biot*(1.0_rk - material%biot)/bulk_modulus(material) &
                               - solid_storage(material))/material%porosity
   end function least_compressibility

   !> Drained bulk modulus [Pa].
   pure real(rk) function bulk_modulus(material)
      type(material_t), intent(in) :: material

      bulk_modulus = material%young/(3.0_rk*(1.0_rk - 2.0_rk*material%poisson))
   end function bulk_modulus

end module scene_fluid_law
